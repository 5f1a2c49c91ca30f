#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "geometry/pinhole_camera.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// A pose as a parameter block: unit quaternion (x, y, z, w), then translation, of cam_from_world.
constexpr int kPoseSize = 7;
/// Refined intrinsics as a parameter block: factor on both focal lengths, k1, k2.
constexpr int kIntrinsicsSize = 3;

/// 2 residuals: whitened distance in pixels between a track's projection and its observation. Intrinsics are fixed: the
/// lens enters through its Jacobian at the measurement, exact up to the curvature of the distortion over the residual
/// (1e-4 of it for 4 pixels). Blocks: pose, point.
class ReprojectionCost final : public ceres::SizedCostFunction<2, kPoseSize, 3> {
 public:
  ReprojectionCost(const ImageMeasurement& measured, double sigma_px);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector2d xy_;
  Eigen::Matrix2d whitened_pixel_from_normalised_;
};

/// As above for a corner of the board. Blocks: pose, ink spread (mm).
class BoardCornerCost final : public ceres::SizedCostFunction<2, kPoseSize, 1> {
 public:
  BoardCornerCost(const BoardCorner& corner, double sigma_px);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d planned_, outward_;
  Eigen::Vector2d xy_;
  Eigen::Matrix2d whitened_pixel_from_normalised_;
};

/// As ReprojectionCost with a camera that is refined. Blocks: pose, point, intrinsics.
class RefinedCameraCost final : public ceres::SizedCostFunction<2, kPoseSize, 3, kIntrinsicsSize> {
 public:
  RefinedCameraCost(const PinholeCamera& camera, const Eigen::Vector2d& pixel, double sigma_px)
      : camera_(camera), pixel_(pixel), whitening_(1 / sigma_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const PinholeCamera& camera_;  ///< supplies what is not refined
  Eigen::Vector2d pixel_;
  double whitening_;
};

}  // namespace drupe
