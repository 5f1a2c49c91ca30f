#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "reconstruction/matching/epipolar.h"

namespace drupe {

/// Essential matrices that five point pairs allow, at most ten, by the action matrix of the ten cubic constraints
/// (Nister 2004; Stewenius, Engels & Nister 2006). Empty for a degenerate sample.
std::vector<Eigen::Matrix3d> SolveFivePoint(const std::array<PointPair, 5>& pairs);

}  // namespace drupe
