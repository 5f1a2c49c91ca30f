#pragma once

#include <Eigen/Core>
#include <memory>

#include "geometry/pinhole_camera.h"
#include "reconstruction/sparse/sfm_state.h"

namespace ceres {
class CostFunction;
}

namespace drupe {

/// A pose as a parameter block: unit quaternion (x, y, z, w), then translation, of cam_from_world.
constexpr int kPoseSize = 7;
/// Refined intrinsics as a parameter block: factor on both focal lengths, k1, k2.
constexpr int kIntrinsicsSize = 3;

/// 2 residuals: whitened distance in pixels between a track's projection and its observation. Intrinsics are fixed: the
/// lens enters through its Jacobian at the measurement, exact up to the curvature of the distortion over the residual
/// (1e-4 of it for 4 pixels). Blocks: pose, point.
std::unique_ptr<ceres::CostFunction> MakeReprojectionCost(const ImageMeasurement& measured, double sigma_px);

/// As above for a corner of the board. Blocks: pose, ink spread (mm).
std::unique_ptr<ceres::CostFunction> MakeBoardCornerCost(const BoardCorner& corner, double sigma_px);

/// As MakeReprojectionCost with a camera that is refined; `camera`, which is borrowed, supplies what is not. Blocks:
/// pose, point, intrinsics.
std::unique_ptr<ceres::CostFunction> MakeRefinedCameraCost(const PinholeCamera& camera, const Eigen::Vector2d& pixel,
                                                           double sigma_px);

}  // namespace drupe
