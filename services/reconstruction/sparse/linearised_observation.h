#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

using PoseStep = Eigen::Matrix<double, 6, 1>;  ///< rotation vector, applied on the left of the rotation; translation

/// An observation at the present pose and point, in units of its standard deviation.
struct LinearisedObservation {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 6> by_pose;  ///< derivative by a PoseStep
  Eigen::Matrix<double, 2, 3> by_point;
};

/// False, and `out` untouched, for a point behind the camera.
inline bool LineariseObservation(const Rigid3& cam_from_world, const ImageMeasurement& measured, double sigma_px,
                                 const Eigen::Vector3d& point, LinearisedObservation& out) {
  const Eigen::Vector3d rotated = cam_from_world.rotation * point, p = rotated + cam_from_world.translation;
  if (p.z() <= 0) return false;
  const double iz = 1 / p.z();
  const Eigen::Vector2d xy = iz * p.head<2>();
  const Eigen::Matrix2d whitened = measured.pixel_from_normalised / sigma_px;
  out.residual.noalias() = whitened * (xy - measured.xy);
  Eigen::Matrix<double, 2, 3> by_camera;
  by_camera.leftCols<2>() = iz * whitened;
  by_camera.col(2).noalias() = -iz * (whitened * xy);
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d row = by_camera.row(k);
    out.by_pose.row(k) << rotated.cross(row).transpose(), row.transpose();
  }
  out.by_point.noalias() = by_camera * cam_from_world.rotation;
  return true;
}

inline Rigid3 ApplyStep(const Rigid3& pose, const PoseStep& step) {
  const double angle = step.head<3>().norm();
  Rigid3 moved = pose;
  if (angle > 0) moved.rotation = Eigen::AngleAxisd(angle, step.head<3>() / angle).toRotationMatrix() * pose.rotation;
  moved.rotation = Eigen::Quaterniond(moved.rotation).normalized().toRotationMatrix();
  moved.translation += step.tail<3>();
  return moved;
}

/// Cauchy's loss rho(s) = b log(1 + s / b) of a squared residual, b the squared scale, and its derivative.
struct CauchyLoss {
  explicit CauchyLoss(double scale) : b(scale * scale) {}
  double Value(double squared) const { return b * std::log1p(squared / b); }
  double Weight(double squared) const { return b / (b + squared); }
  double b;
};

}  // namespace drupe
