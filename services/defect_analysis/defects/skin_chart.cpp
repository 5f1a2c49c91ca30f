#include "defect_analysis/defects/skin_chart.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace drupe {

SkinChart::SkinChart(const FruitSurface& surface, const Eigen::Vector3d& direction)
    : surface_(&surface), axis_(direction.normalized()), scale_(surface.RadiusAt(direction.cast<float>())) {
  right_ = axis_.unitOrthogonal();
  down_ = axis_.cross(right_);
}

Eigen::Vector2d SkinChart::FlatFromDirection(const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d d = direction.normalized();
  const double stretch = scale_ * std::sqrt(2 / std::max(1e-9, 1 + d.dot(axis_)));
  return {stretch * d.dot(right_), stretch * d.dot(down_)};
}

Eigen::Vector3d SkinChart::DirectionFromFlat(const Eigen::Vector2d& flat) const {
  const Eigen::Vector2d p = flat / scale_;
  const double squared = std::min(3.99, p.squaredNorm());
  const double stretch = std::sqrt(1 - squared / 4);
  return (1 - squared / 2) * axis_ + stretch * (p.x() * right_ + p.y() * down_);
}

Eigen::Vector3d SkinChart::PointFromFlat(const Eigen::Vector2d& flat) const {
  return surface_->PointAt(DirectionFromFlat(flat));
}

double SkinChart::AreaScale(const Eigen::Vector2d& flat) const {
  // The projection keeps solid angles, so only the surface's distance and tilt remain.
  return surface_->AreaPerSolidAngle(DirectionFromFlat(flat)) / (scale_ * scale_);
}

}  // namespace drupe
