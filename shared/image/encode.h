#pragma once

#include <string>

#include "base/status.h"
#include "image/image.h"

namespace drupe {

/// A PNG file of an RGB picture (3 channels). Errors: 500 `png_not_written`.
Result<std::string> EncodePng(const RgbImage& image);

}  // namespace drupe
