#pragma once

#include <cmath>

#include "defect_analysis/defects/contour.h"

namespace drupe {

/// Points of a circle's arc from one angle to another, counter-clockwise, for tests.
inline Polygon ArcOf(const Eigen::Vector2d& middle, double radius, double from, double to, int points) {
  Polygon polygon;
  for (int k = 0; k < points; ++k) {
    const double t = from + (to - from) * (k + 0.5) / points;
    polygon.push_back(middle + radius * Eigen::Vector2d(std::cos(t), std::sin(t)));
  }
  return polygon;
}

}  // namespace drupe
