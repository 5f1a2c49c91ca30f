#include "reconstruction/features/features.h"

#include <algorithm>
#include <string>

#include "base/option_check.h"
#include "reconstruction/features/budget.h"
#include "reconstruction/features/descriptor.h"
#include "reconstruction/features/extrema.h"
#include "reconstruction/features/scale_space.h"

namespace drupe {
namespace {

constexpr int kMinSide = 16;
/// Keypoints described between two looks at the context.
constexpr std::size_t kCancelInterval = 1000;

Status CheckInput(const GrayImage& image, const GrayImage* mask) {
  if (std::min(image.width(), image.height()) < kMinSide) {
    return Unprocessable("image_too_small", "the picture has " + std::to_string(image.width()) + "x" +
                                                std::to_string(image.height()) + " pixels; each side needs 16");
  }
  if (mask != nullptr && (mask->width() != image.width() || mask->height() != image.height())) {
    return InvalidArgument("invalid_mask", "the mask must have the size of the picture", "mask");
  }
  return Status::Ok();
}

void AddKeypoints(const Octave& octave, const Extremum& extremum, int max_orientations, Features& features) {
  for (const float orientation : DominantOrientations(octave, extremum, max_orientations)) {
    const float step = octave.pixel_step;
    features.keypoints.push_back(
        {extremum.x * step, extremum.y * step, extremum.sigma * step, orientation, extremum.response});
    features.descriptors.resize(features.keypoints.size() * Features::kDimension);
    DescribeExtremum(octave, extremum, orientation,
                     features.descriptors.data() + features.descriptors.size() - Features::kDimension);
  }
}

}  // namespace

Status FeatureOptions::Check() const {
  const int octave = first_octave.value_or(0);
  DRUPE_RETURN_IF_ERROR(CheckOption(octave >= -1 && octave <= 4, "first_octave", "-1 to 4"));
  DRUPE_RETURN_IF_ERROR(CheckOption(doubling_max_pixels >= 0, "doubling_max_pixels", "0 or more"));
  DRUPE_RETURN_IF_ERROR(CheckOption(max_octaves >= 1 && max_octaves <= 16, "max_octaves", "1 to 16"));
  DRUPE_RETURN_IF_ERROR(CheckOption(scales_per_octave >= 1 && scales_per_octave <= 5, "scales_per_octave", "1 to 5"));
  DRUPE_RETURN_IF_ERROR(CheckOption(base_sigma >= 1.2 && base_sigma <= 2.4, "base_sigma", "1.2 to 2.4"));
  DRUPE_RETURN_IF_ERROR(CheckOption(input_sigma >= 0 && input_sigma < 0.6, "input_sigma", "0 to 0.6"));
  DRUPE_RETURN_IF_ERROR(CheckOption(peak_threshold > 0 && peak_threshold < 1, "peak_threshold", "between 0 and 1"));
  DRUPE_RETURN_IF_ERROR(CheckOption(edge_threshold > 1, "edge_threshold", "larger than 1"));
  DRUPE_RETURN_IF_ERROR(CheckOption(max_orientations >= 1 && max_orientations <= 4, "max_orientations", "1 to 4"));
  DRUPE_RETURN_IF_ERROR(CheckOption(max_features >= 1 && max_features <= 1'000'000, "max_features", "1 to 1000000"));
  return CheckOption(grid_cell_px >= 8 && grid_cell_px <= 4096, "grid_cell_px", "8 to 4096");
}

Result<Features> RunFeatures(const GrayImage& image, const FeatureOptions& options, const RunContext& context,
                             const GrayImage* mask) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_RETURN_IF_ERROR(CheckInput(image, mask));
  ExtremaFinder finder(options, mask);
  DRUPE_ASSIGN_OR_RETURN(const std::vector<Octave> octaves, BuildScaleSpace(image, options, context, finder));
  const std::vector<Extremum> selected =
      SelectSpread(finder.Take(), octaves, options.grid_cell_px, options.max_features);
  Features features;
  features.keypoints.reserve(selected.size() * 5 / 4);
  features.descriptors.reserve(selected.size() * 5 / 4 * Features::kDimension);
  for (std::size_t i = 0; i < selected.size(); ++i) {
    if (i % kCancelInterval == 0) DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
    AddKeypoints(octaves[selected[i].octave], selected[i], options.max_orientations, features);
  }
  return features;
}

}  // namespace drupe
