#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/rigid3.h"
#include "reconstruction/matching/epipolar.h"
#include "reconstruction/matching/matching.h"
#include "reconstruction/matching/prepared_picture.h"
#include "reconstruction/matching/ransac.h"
#include "scene/view_graph.h"

namespace drupe {

/// Matches of one pair by places in PreparedPicture::kept, with the coordinates of both ends.
struct PairMatches {
  std::vector<FeatureMatch> pairs;
  std::vector<PointPair> points;

  void Add(FeatureMatch match, const PreparedPicture& first, const PreparedPicture& second);
  PairMatches Subset(const std::vector<int>& indices) const;
  std::size_t size() const { return pairs.size(); }
};

/// The value below which `share` of the values lie; `values` not empty.
template <typename T>
T Quantile(std::vector<T> values, double share) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// True when the middle match moves less than the error: then nothing turned between the pictures.
bool StandsStill(const PairMatches& matches, double max_error);

/// Of the rays of all matches (one at least), radians.
double MedianAngle(const Rigid3& pose, const PairMatches& matches);

/// What every way to match a pair starts from, and the steps that all of them take.
struct PairTask {
  const PreparedPicture& first;
  const PreparedPicture& second;
  const MatchingOptions& options;
  double max_error;  ///< in the unit of the places
  std::uint64_t seed;

  bool IsEnough(const PairMatches& matches) const { return static_cast<int>(matches.size()) >= options.min_inliers; }
  RansacOptions Ransac(double error) const {
    return {error, options.confidence, options.max_iterations, seed, options.min_inliers};
  }

  /// Matches by descriptors alone (MatchDescriptors).
  PairMatches Putative() const;

  /// The verified matches (one at least) and those that a second search along the epipolar lines finds between features
  /// that have none yet, where and with what looks the verified ones lead to expect them.
  PairMatches Guided(const PairMatches& verified, const EpipolarTransfer& transfer) const;

  /// What the graph keeps of verified matches (one at least) of `putative_count`: by keypoints, ascending, with the
  /// share in one plane.
  TwoViewMatches Describe(ImagePair pair, const PairMatches& verified, std::size_t putative_count) const;
};

}  // namespace drupe
