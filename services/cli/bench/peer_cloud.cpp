#include "cli/bench/peer_cloud.h"

#include <filesystem>
#include <utility>

#include "image/decode.h"
#include "reconstruction/dense/view_pyramid.h"

namespace drupe {

Result<RgbImage> FlatPicture(const TruthSet& set, const SparseModel& model, const View& view) {
  for (const SourceImage& image : set.input.images) {
    if (image.name != view.image) continue;
    DRUPE_ASSIGN_OR_RETURN(const std::string bytes, image.read());
    DRUPE_ASSIGN_OR_RETURN(const RgbImage picture, DecodeRgb(bytes, set.input.limits));
    dense::DenseView flat;
    dense::BuildPyramid(picture, model.camera, {0, 0, picture.width(), picture.height()}, 1, &flat);
    return std::move(flat.rgb);
  }
  return InvalidArgument("bad_truth", "there is no picture " + view.image, "images");
}

Status MakeFolders(const std::string& directory, const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    std::error_code error;
    std::filesystem::create_directories(directory + "/" + folder, error);
    if (error) return InvalidArgument("bad_output", "cannot create " + directory + ": " + error.message(), "--work");
  }
  return Status::Ok();
}

}  // namespace drupe
