#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "reconstruction/matching/epipolar.h"
#include "reconstruction/matching/ransac.h"

namespace drupe {

/// The epipolar geometry of two pictures of unknown lenses.
struct FundamentalEstimate {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();  ///< second^T F first = 0; norm 1, rank 2
  std::vector<int> inliers;                          ///< ascending; within max_error (Sampson)
  bool from_plane = false;                           ///< completed from a plane that held a whole sample
};

/// The fundamental matrix that explains most pairs: seven-point samples scored by MSAC (Torr & Zisserman 2000), every
/// new best one locally optimised (Chum, Matas & Kittler 2003). A sample of which five points or more lie in one plane
/// fixes nothing but that plane; such a one is completed from the plane and two points off it (DEGENSAC: Chum, Werner &
/// Matas 2005). Deterministic for a seed. Nothing for fewer than seven pairs or when no sample gives a matrix; where
/// all pairs lie in one plane, one of the many matrices that explain them.
std::optional<FundamentalEstimate> EstimateFundamental(std::span<const PointPair> pairs, const RansacOptions& options);

/// Least squares over the Sampson distances below max_error, from `start` of rank 2: Levenberg-Marquardt on the seven
/// parameters of the orthonormal representation (Bartoli & Sturm 2004).
Eigen::Matrix3d RefineFundamental(std::span<const PointPair> pairs, double max_error, const Eigen::Matrix3d& start);

/// The pairs within max_error of their epipolar lines, ascending.
std::vector<int> InliersOf(const Eigen::Matrix3d& fundamental, std::span<const PointPair> pairs, double max_error);

}  // namespace drupe
