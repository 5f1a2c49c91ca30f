#pragma once

#include <filesystem>
#include <vector>

#include "base/limits.h"
#include "base/status.h"

namespace drupe {

/// The pictures of a directory (.jpg .jpeg .png .tif .tiff, any case; not its sub-directories), sorted by name, which
/// is taken as the order of the turn. Errors: 404 `directory_not_found`, 422 `too_few_images`, 413 `too_many_images`.
Result<std::vector<std::filesystem::path>> ListImages(const std::filesystem::path& directory, const Limits& limits);

}  // namespace drupe
