#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace drupe {

/// A rigid motion. `b_from_a` takes a point from frame a to frame b: x_b = rotation * x_a + translation. Poses of views
/// are `cam_from_world` (x right, y down, z forward, mm where the scale is metric).
struct Rigid3 {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
  /// c_from_a = c_from_b * b_from_a
  Rigid3 operator*(const Rigid3& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  Rigid3 Inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }
  /// For a cam_from_world: the camera's optical centre in the world.
  Eigen::Vector3d Centre() const { return -(rotation.transpose() * translation); }
};

}  // namespace drupe
