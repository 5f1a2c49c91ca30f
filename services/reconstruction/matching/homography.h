#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/rigid3.h"
#include "reconstruction/matching/epipolar.h"

namespace drupe {

/// The homography that explains most pairs.
struct Homography {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();  ///< second ~ matrix * first
  double inlier_share = 0;                               ///< 0..1; near 1 for a plane or a camera that only turned
};

/// By RANSAC with local optimisation; a pair is explained within max_error (transfer into the second picture). Nothing
/// for fewer than four pairs.
std::optional<Homography> EstimateHomography(std::span<const PointPair> pairs, double max_error, std::uint64_t seed);

/// Squared distance between where a homography moves a pair's first place and its second one; infinite when it moves it
/// nowhere.
double SquaredTransfer(const Eigen::Matrix3d& homography, const PointPair& pair);

/// Least squares over the pairs that `start` explains within max_error; `start` itself when these are fewer than four
/// or the solution explains fewer.
Eigen::Matrix3d RefineHomography(const Eigen::Matrix3d& start, std::span<const PointPair> pairs, double max_error);

/// The two relative poses (|translation| = 1) under which a plane gives this homography (Ma, Soatto, Kosecka & Sastry
/// 2004, section 5.3.3). Points of the plane alone cannot tell which is the real one. Empty for a camera that only
/// turned.
std::vector<Rigid3> PosesFromHomography(const Eigen::Matrix3d& homography);

}  // namespace drupe
