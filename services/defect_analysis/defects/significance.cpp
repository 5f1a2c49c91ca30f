#include "defect_analysis/defects/significance.h"

#include <algorithm>

#include "image/colour.h"

namespace drupe {

double ContrastBeyondGloss(const TransitionField& field, double lightness_weight) {
  const double gloss = std::max(0.0, (field.defect_linear - field.healthy_linear).minCoeff());
  const Eigen::Vector3d pigment = field.defect_linear - Eigen::Vector3d::Constant(gloss);
  Eigen::Vector3f difference = LabFromLinear(pigment.cast<float>()) - LabFromLinear(field.healthy_linear.cast<float>());
  difference[0] *= static_cast<float>(lightness_weight);
  return difference.norm();
}

bool StandsOut(const TransitionField& field, double threshold, const SegmentationOptions& options) {
  return field.noise * options.local_sigma <= 1 && ContrastBeyondGloss(field, options.lightness_weight) >= threshold;
}

}  // namespace drupe
