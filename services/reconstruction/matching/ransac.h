#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>

#include "reconstruction/matching/epipolar.h"

namespace drupe {

struct RansacOptions {
  double max_error = 0;  ///< > 0; Sampson distance of an inlier, in the unit of the coordinates
  double confidence = 0.9999;
  int max_iterations = 2'000;
  std::uint64_t seed = 1;
  /// Models with fewer inliers are of no use: sampling ends once one with as many would have been found, with the same
  /// confidence. 0: nothing is known of that.
  int min_inliers = 0;
};

/// `kCount` different numbers below `size`, size >= kCount. Plain remainders: the same on every standard library.
template <int kCount>
std::array<std::size_t, kCount> DrawDistinct(std::size_t size, std::mt19937_64& random) {
  std::array<std::size_t, kCount> drawn;
  for (int i = 0; i < kCount; ++i) {
    bool repeated = true;
    while (repeated) {
      drawn[i] = random() % size;
      repeated = false;
      for (int j = 0; j < i; ++j) repeated |= drawn[j] == drawn[i];
    }
  }
  return drawn;
}

/// Samples needed to draw one without outliers with probability `confidence`.
inline double RequiredIterations(std::size_t inliers, std::size_t size, int sample, double confidence) {
  const double good = std::pow(static_cast<double>(inliers) / static_cast<double>(size), sample);
  if (good >= 1) return 1;
  if (good <= 0) return std::numeric_limits<double>::infinity();
  return std::log(1 - confidence) / std::log1p(-good);
}

/// The most samples of `sample` pairs each that are worth drawing from `size` pairs.
inline double MostIterations(std::size_t size, int sample, const RansacOptions& options) {
  const double enough =
      RequiredIterations(static_cast<std::size_t>(options.min_inliers), size, sample, options.confidence);
  return std::min<double>(options.max_iterations, enough);
}

/// MSAC's cost of a model and the number of its inliers.
struct Score {
  double cost = std::numeric_limits<double>::infinity();
  std::size_t inliers = 0;
};

/// Sum of squared Sampson distances, each at most max_error^2. Stops early beyond `give_up`.
inline Score ScoreEpipolar(const Eigen::Matrix3d& e, std::span<const PointPair> pairs, double max_error,
                           double give_up) {
  const double limit = max_error * max_error;
  Score score{0, 0};
  for (const PointPair& pair : pairs) {
    const double squared = SquaredSampson(e, pair);
    if (squared < limit) ++score.inliers;
    score.cost += squared < limit ? squared : limit;
    if (score.cost > give_up) break;
  }
  return score;
}

}  // namespace drupe
