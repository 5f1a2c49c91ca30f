#include "cli/image_directory.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

namespace drupe {

namespace {

bool IsImageName(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 5> kExtensions = {".jpg", ".jpeg", ".png", ".tif", ".tiff"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

}  // namespace

Result<std::vector<std::filesystem::path>> ListImages(const std::filesystem::path& directory, const Limits& limits) {
  std::error_code error;
  std::filesystem::directory_iterator entries(directory, error);
  if (error) return NotFound("directory_not_found", "cannot read the directory " + directory.string());
  std::vector<std::filesystem::path> images;
  for (const auto& entry : entries) {
    if (entry.is_regular_file(error) && IsImageName(entry.path())) images.push_back(entry.path());
  }
  std::sort(images.begin(), images.end());
  if (static_cast<int>(images.size()) < limits.min_images) {
    return Unprocessable("too_few_images", directory.string() + " holds " + std::to_string(images.size()) +
                                               " pictures; at least " + std::to_string(limits.min_images) +
                                               " are needed");
  }
  if (static_cast<int>(images.size()) > limits.max_images) {
    return Status(StatusKind::kTooLarge, "too_many_images",
                  directory.string() + " holds " + std::to_string(images.size()) + " pictures; the limit is " +
                      std::to_string(limits.max_images));
  }
  return images;
}

}  // namespace drupe
