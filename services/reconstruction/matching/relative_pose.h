#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/rigid3.h"
#include "reconstruction/matching/epipolar.h"

namespace drupe {

struct RansacOptions {
  double max_error = 0;  ///< > 0; Sampson distance of an inlier, in the unit of the coordinates
  double confidence = 0.9999;
  int max_iterations = 2'000;
  std::uint64_t seed = 1;
};

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
