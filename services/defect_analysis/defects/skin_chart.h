#pragma once

#include <Eigen/Core>

#include "scene/fruit_cloud.h"

namespace drupe {

/// A flat map of the skin about one direction: Lambert's azimuthal equal-area projection of the directions about the
/// fruit's centre, in mm at the map's middle. Good to well beyond a hemisphere.
class SkinChart {
 public:
  SkinChart(const FruitSurface& surface, const Eigen::Vector3d& direction);

  Eigen::Vector2d FlatFromDirection(const Eigen::Vector3d& direction) const;
  Eigen::Vector3d DirectionFromFlat(const Eigen::Vector2d& flat) const;  ///< unit length
  /// The skin's point, world frame, mm.
  Eigen::Vector3d PointFromFlat(const Eigen::Vector2d& flat) const;
  /// Area of skin for a unit of flat area: what turns an area on the map into one on the curved skin.
  double AreaScale(const Eigen::Vector2d& flat) const;

  const FruitSurface& surface() const { return *surface_; }
  const Eigen::Vector3d& direction() const { return axis_; }

 private:
  const FruitSurface* surface_;
  Eigen::Vector3d axis_, right_, down_;
  double scale_;  ///< radius at the map's middle
};

}  // namespace drupe
