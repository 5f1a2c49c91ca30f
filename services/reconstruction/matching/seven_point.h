#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "reconstruction/matching/epipolar.h"

namespace drupe {

/// The fundamental matrices (norm 1, determinant 0) with second^T F first = 0 for all seven pairs (Hartley & Zisserman
/// 2004, section 11.1.2): one or three. None when the pairs leave more than a pencil of matrices open. Coordinates are
/// expected to be about 1.
std::vector<Eigen::Matrix3d> SolveSevenPoint(const std::array<PointPair, 7>& pairs);

}  // namespace drupe
