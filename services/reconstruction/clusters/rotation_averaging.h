#pragma once

#include <Eigen/Core>
#include <vector>

namespace drupe {

/// A measured rotation between two images.
struct RelativeRotation {
  int first = 0, second = 0;
  Eigen::Matrix3d second_from_first = Eigen::Matrix3d::Identity();
  double weight = 1;  ///< > 0; how much it is trusted
};

/// Rotations of `image_count` images that fit the measured ones, up to a common one per connected part: begun along the
/// spanning tree of the largest weights, refined by iteratively reweighted least squares with a Geman-McClure loss of
/// scale `scale_rad` (Chatterjee & Govindu 2013). Images without a measurement keep the identity. Deterministic.
std::vector<Eigen::Matrix3d> AverageRotations(int image_count, const std::vector<RelativeRotation>& measured,
                                              double scale_rad);

/// Angle between a measured rotation and the one between two averaged ones, radians.
double RotationResidual(const RelativeRotation& measured, const std::vector<Eigen::Matrix3d>& rotations);

}  // namespace drupe
