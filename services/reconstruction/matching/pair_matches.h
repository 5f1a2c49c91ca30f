#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "geometry/rigid3.h"
#include "reconstruction/matching/epipolar.h"
#include "reconstruction/matching/guided.h"
#include "reconstruction/matching/prepared_picture.h"
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

/// Matches by descriptors alone (MatchDescriptors).
PairMatches PutativeMatches(const PreparedPicture& first, const PreparedPicture& second, double max_ratio);

/// What verified matches (one at least) say about where further ones can lie, and how much these may look apart.
GuidedOptions GuideFrom(const PairMatches& verified, const PreparedPicture& first, const PreparedPicture& second,
                        const EpipolarTransfer& transfer, double max_error, double max_ratio);

/// The verified matches and, of the guided ones, those between features that have none yet.
PairMatches Extended(const PairMatches& verified, const std::vector<FeatureMatch>& guided, const PreparedPicture& first,
                     const PreparedPicture& second);

/// True when the middle match moves less than the error: then nothing turned between the pictures.
bool StandsStill(const PairMatches& matches, double max_error);

/// Of the rays of all matches (one at least), radians.
double MedianAngle(const Rigid3& pose, const PairMatches& matches);

/// What the graph keeps of verified matches (one at least): by keypoints, ascending, with the share in one plane.
TwoViewMatches DescribePair(ImagePair pair, const PairMatches& verified, const PreparedPicture& first,
                            const PreparedPicture& second, double max_error, std::uint64_t seed);

}  // namespace drupe
