#include "geometry/pinhole_camera.h"

#include <Eigen/LU>
#include <algorithm>

namespace drupe {

namespace {

/// Distorted normalised coordinates and, when asked for, their Jacobian by the undistorted ones.
Eigen::Vector2d Distort(const std::array<double, 5>& d, const Eigen::Vector2d& xy, Eigen::Matrix2d* jacobian) {
  const double x = xy.x(), y = xy.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  if (jacobian != nullptr) {
    const double slope = d[0] + r2 * (2.0 * d[1] + 3.0 * d[4] * r2);  // d(radial)/d(r2)
    (*jacobian)(0, 0) = radial + 2.0 * x * x * slope + 2.0 * d[2] * y + 6.0 * d[3] * x;
    (*jacobian)(0, 1) = 2.0 * x * y * slope + 2.0 * d[2] * x + 2.0 * d[3] * y;
    (*jacobian)(1, 0) = (*jacobian)(0, 1);
    (*jacobian)(1, 1) = radial + 2.0 * y * y * slope + 6.0 * d[2] * y + 2.0 * d[3] * x;
  }
  return {x * radial + 2.0 * d[2] * x * y + d[3] * (r2 + 2.0 * x * x),
          y * radial + d[2] * (r2 + 2.0 * y * y) + 2.0 * d[3] * x * y};
}

}  // namespace

Eigen::Vector2d PinholeCamera::PixelFromNormalised(const Eigen::Vector2d& xy) const {
  return PixelFromNormalised(xy, nullptr);
}

Eigen::Vector2d PinholeCamera::PixelFromNormalised(const Eigen::Vector2d& xy, Eigen::Matrix2d* jacobian) const {
  const Eigen::Vector2d distorted = Distort(dist, xy, jacobian);
  if (jacobian != nullptr) {
    jacobian->row(0) *= fx;
    jacobian->row(1) *= fy;
  }
  return {fx * distorted.x() + cx, fy * distorted.y() + cy};
}

Eigen::Vector2d PinholeCamera::NormalisedFromPixel(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d target((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (!HasDistortion()) return target;
  Eigen::Vector2d xy = target;
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::Matrix2d jacobian;
    const Eigen::Vector2d residual = Distort(dist, xy, &jacobian) - target;
    const Eigen::Vector2d step = jacobian.inverse() * residual;
    xy -= step;
    if (step.squaredNorm() < 1e-24) break;
  }
  return xy;
}

std::optional<Eigen::Vector2d> PinholeCamera::Project(const Eigen::Vector3d& point_in_cam) const {
  if (point_in_cam.z() <= 0.0) return std::nullopt;
  return PixelFromNormalised(point_in_cam.head<2>() / point_in_cam.z());
}

Eigen::Matrix3d PinholeCamera::K() const {
  Eigen::Matrix3d k;
  k << fx, 0, cx, 0, fy, cy, 0, 0, 1;
  return k;
}

PinholeCamera PinholeCamera::WithoutDistortion() const {
  PinholeCamera camera = *this;
  camera.dist = {};
  return camera;
}

bool PinholeCamera::HasDistortion() const {
  return std::any_of(dist.begin(), dist.end(), [](double k) { return k != 0.0; });
}

}  // namespace drupe
