#pragma once

#include <string>

#include "image/image.h"

namespace drupe {

/// How many different markers of a dictionary are seen; a quick look that measures nothing. 0 for an unknown
/// dictionary.
int CountMarkers(const GrayImage& image, const std::string& dictionary);

}  // namespace drupe
