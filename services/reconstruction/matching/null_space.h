#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "reconstruction/matching/epipolar.h"

namespace drupe {

/// The 9 - n orthonormal matrices that span those with second^T F first = 0 for all n <= 8 pairs.
std::vector<Eigen::Matrix3d> EpipolarNullSpace(std::span<const PointPair> pairs);

}  // namespace drupe
