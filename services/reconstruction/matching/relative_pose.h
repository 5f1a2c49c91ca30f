#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/rigid3.h"
#include "reconstruction/matching/epipolar.h"
#include "reconstruction/matching/ransac.h"

namespace drupe {

struct RelativePose {
  Rigid3 second_from_first;  ///< |translation| = 1
  std::vector<int> inliers;  ///< ascending; within max_error and in front of both cameras
};

/// The relative pose of two calibrated pictures: five-point samples scored by MSAC, every new best one locally
/// optimised (Chum, Matas & Kittler 2003; Torr & Zisserman 2000). Nothing when no sample gives a pose.
std::optional<RelativePose> EstimateRelativePose(std::span<const PointPair> pairs, const RansacOptions& options);

/// Least squares over the Sampson distances below max_error, from `start` (Gauss-Newton on the five parameters).
Rigid3 RefineRelativePose(std::span<const PointPair> pairs, double max_error, const Rigid3& start);

/// The pairs within max_error of their epipolar lines that lie in front of both cameras, ascending.
std::vector<int> InliersOf(const Rigid3& second_from_first, std::span<const PointPair> pairs, double max_error);

}  // namespace drupe
