#include "defect_analysis/defects/significance.h"

#include <algorithm>

#include "image/colour.h"

namespace drupe {

namespace {

// The colour without the light that it has more than the skin.
Eigen::Vector3d WithoutAddedLight(const Eigen::Vector3d& colour, const Eigen::Vector3d& skin) {
  // colour = gain * skin + gloss, by least squares over the channels.
  const Eigen::Array3d skin_dev = skin.array() - skin.mean();
  const double gain = (skin_dev * colour.array()).sum() / std::max(1e-9, skin_dev.square().sum());
  const double gloss = colour.mean() - gain * skin.mean();
  if (gain > 1 && gloss > 0) return (colour.array() - gloss) / gain;
  if (gain > 1) return colour / std::max(1.0, colour.dot(skin) / skin.squaredNorm());
  return colour.array() - std::max(0.0, (colour - skin).minCoeff());
}

}  // namespace

double ContrastBeyondLight(const TransitionField& field, double lightness_weight) {
  const Eigen::Vector3d pigment = WithoutAddedLight(field.defect_linear, field.healthy_linear);
  Eigen::Vector3f difference = LabFromLinear(pigment.cast<float>()) - LabFromLinear(field.healthy_linear.cast<float>());
  difference[0] *= static_cast<float>(lightness_weight);
  return difference.norm();
}

bool StandsOut(const TransitionField& field, double threshold, const SegmentationOptions& options) {
  return field.noise * options.local_sigma <= 1 && ContrastBeyondLight(field, options.lightness_weight) >= threshold;
}

}  // namespace drupe
