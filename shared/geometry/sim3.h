#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/status.h"
#include "geometry/rigid3.h"

namespace drupe {

/// A similarity: x_b = scale * rotation * x_a + translation.
struct Sim3 {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
  Sim3 operator*(const Sim3& other) const {
    return {scale * other.scale, rotation * other.rotation, scale * (rotation * other.translation) + translation};
  }
  Sim3 Inverse() const {
    const Eigen::Matrix3d back = rotation.transpose();
    return {1.0 / scale, back, -(back * translation) / scale};
  }
};

/// The similarity that maps `from` onto `to` with least squared error (Umeyama 1991). Both have the same size, at least
/// 3 points that are not on one line; otherwise 422 `degenerate_alignment`.
Result<Sim3> FitSim3(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to);

/// The pose of a view after its world was mapped by `new_from_old`: same picture, new world (camera units rescaled).
Rigid3 TransformPose(const Rigid3& cam_from_old, const Sim3& new_from_old);

}  // namespace drupe
