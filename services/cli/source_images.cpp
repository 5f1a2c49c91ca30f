#include "cli/source_images.h"

#include <filesystem>

#include "base/files.h"
#include "cli/image_directory.h"

namespace drupe {

Result<std::vector<SourceImage>> LoadSourceImages(const std::string& directory, const Limits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<std::filesystem::path> paths, ListImages(directory, limits));
  std::vector<SourceImage> images;
  for (const std::filesystem::path& path : paths) {
    const std::size_t max_bytes = limits.max_image_bytes;
    images.push_back({path.filename().string(), [path, max_bytes] { return ReadFile(path, max_bytes); }});
  }
  return images;
}

}  // namespace drupe
