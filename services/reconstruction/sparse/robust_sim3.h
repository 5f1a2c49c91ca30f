#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/sim3.h"

namespace drupe {

/// One place in two frames.
struct FramePair {
  Eigen::Vector3d from, to;
  double tolerance = 0;  ///< > 0; largest distance in the second frame at which they agree
};

struct RobustSim3 {
  Sim3 to_from;
  std::vector<std::uint8_t> is_inlier;  ///< one a pair
  int inlier_count = 0;
};

/// The similarity that most pairs agree on: samples of three by RANSAC with truncated squared errors, each best one
/// refined by least squares on what agrees with it (Chum, Matas & Kittler 2003). Nothing for fewer than three pairs, or
/// when no sample has more inliers than itself. Deterministic for a seed.
std::optional<RobustSim3> EstimateSim3(std::span<const FramePair> pairs, std::uint64_t seed);

}  // namespace drupe
