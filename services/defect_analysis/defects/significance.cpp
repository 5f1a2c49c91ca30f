#include "defect_analysis/defects/significance.h"

#include <algorithm>

#include "defect_analysis/defects/stain_edge.h"
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

double WeightedDifference(const Eigen::Vector3d& colour, const Eigen::Vector3d& skin, double lightness_weight) {
  Eigen::Vector3f difference = LabFromLinear(colour.cast<float>()) - LabFromLinear(skin.cast<float>());
  difference[0] *= static_cast<float>(lightness_weight);
  return difference.norm();
}

}  // namespace

double ContrastBeyondLight(const TransitionField& field, double lightness_weight) {
  const Eigen::Vector3d pigment = WithoutAddedLight(field.defect_linear, field.healthy_linear);
  return WeightedDifference(pigment, field.healthy_linear, lightness_weight);
}

double Contrast(const TransitionField& field, double lightness_weight) {
  return WeightedDifference(field.defect_linear, field.healthy_linear, lightness_weight);
}

bool StandsOut(const TransitionField& field, double threshold, const DefectOptions& options) {
  if (field.noise * options.segmentation.local_sigma > 1) return false;
  if (ContrastBeyondLight(field, options.segmentation.lightness_weight) >= threshold) return true;
  return StandsOutFaintly(field, threshold, options);
}

bool StandsOutFaintly(const TransitionField& field, double threshold, const DefectOptions& options) {
  return field.noise * options.segmentation.local_sigma <= 1 &&
         Contrast(field, options.segmentation.lightness_weight) >= threshold &&
         HasStainsEdge(field, options.contour.level, options.cluster.min_area_mm2);
}

}  // namespace drupe
