#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/rigid3.h"

namespace drupe {

/// The poses (at most 4) from which three world points are seen along three rays: Grunert's quartic as given by
/// Haralick et al. 1994, roots polished by Newton's method. `rays` are normalised image coordinates (x/z, y/z). Empty
/// for points on one line or coinciding rays.
std::vector<Rigid3> SolveP3p(const std::array<Eigen::Vector3d, 3>& points, const std::array<Eigen::Vector2d, 3>& rays);

}  // namespace drupe
