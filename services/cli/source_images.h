#pragma once

#include <string>
#include <vector>

#include "base/limits.h"
#include "base/status.h"
#include "reconstruction/pipeline.h"

namespace drupe {

/// The pictures of a directory as the pipeline reads them: in the order of their names, each read when it is needed.
/// Errors: those of ListImages.
Result<std::vector<SourceImage>> LoadSourceImages(const std::string& directory, const Limits& limits);

}  // namespace drupe
