#include "reconstruction/matching/pair_matches.h"

#include <cstdint>
#include <optional>

#include "reconstruction/matching/descriptor_matching.h"
#include "reconstruction/matching/guided.h"
#include "reconstruction/matching/homography.h"
#include "scene/descriptor_distance.h"

namespace drupe {
namespace {

/// How much further apart (squared) the looks of further matches may be than those of most verified ones, which are
/// between the coarsest features: as far as these where every feature was compared with every other, and the farther
/// the more features were not, since finer ones look less alike.
double LookMargin(const PreparedPicture& first, const PreparedPicture& second) {
  constexpr double kForFineOnes = 1.8;
  const auto kept = static_cast<double>(std::max<std::size_t>(1, first.kept.size() + second.kept.size()));
  const auto compared = static_cast<double>(first.packed.size() + second.packed.size());
  return 1 + kForFineOnes * (1 - compared / kept);
}

/// What verified matches say about where further ones can lie, and how much these may look apart.
GuidedOptions GuideFrom(const PairTask& task, const PairMatches& verified, const EpipolarTransfer& transfer) {
  std::vector<double> inverse_depths;
  std::vector<std::int32_t> distances;
  for (std::size_t i = 0; i < verified.size(); ++i) {
    inverse_depths.push_back(std::max(0.0, InverseDepthOf(transfer, verified.points[i])));
    const FeatureMatch& match = verified.pairs[i];
    distances.push_back(SquaredDistance(task.first.Descriptor(match.first), task.second.Descriptor(match.second)));
  }
  GuidedOptions guide;
  guide.max_error = task.max_error;
  guide.max_ratio = task.options.guided_max_ratio;
  const double low = Quantile(inverse_depths, 0.01), high = Quantile(inverse_depths, 0.99);
  const double margin = 0.25 * (high - low);
  guide.inverse_depth_min = std::max(0.0, low - margin);
  guide.inverse_depth_max = high + margin;
  guide.max_squared_distance =
      static_cast<std::int32_t>(LookMargin(task.first, task.second) * Quantile(distances, 0.95));
  return guide;
}

}  // namespace

void PairMatches::Add(FeatureMatch match, const PreparedPicture& first, const PreparedPicture& second) {
  pairs.push_back(match);
  points.push_back({first.places[match.first], second.places[match.second]});
}

PairMatches PairMatches::Subset(const std::vector<int>& indices) const {
  PairMatches subset;
  for (const int i : indices) {
    subset.pairs.push_back(pairs[i]);
    subset.points.push_back(points[i]);
  }
  return subset;
}

bool StandsStill(const PairMatches& matches, double max_error) {
  if (matches.points.empty()) return false;
  std::vector<double> moved;
  for (const PointPair& points : matches.points) moved.push_back((points.first - points.second).norm());
  return Quantile(moved, 0.5) < max_error;
}

double MedianAngle(const Rigid3& pose, const PairMatches& matches) {
  std::vector<double> angles;
  for (const PointPair& points : matches.points) angles.push_back(TriangulationAngle(pose, points));
  return Quantile(angles, 0.5);
}

PairMatches PairTask::Putative() const {
  PairMatches putative;
  for (const FeatureMatch& match : MatchDescriptors(first, second, options.max_ratio)) {
    putative.Add(match, first, second);
  }
  return putative;
}

PairMatches PairTask::Guided(const PairMatches& verified, const EpipolarTransfer& transfer) const {
  std::vector<bool> used_first(first.kept.size()), used_second(second.kept.size());
  for (const FeatureMatch& match : verified.pairs) used_first[match.first] = used_second[match.second] = true;
  PairMatches extended = verified;
  for (const FeatureMatch& match : MatchGuided(first, second, transfer, GuideFrom(*this, verified, transfer))) {
    if (!used_first[match.first] && !used_second[match.second]) extended.Add(match, first, second);
  }
  return extended;
}

TwoViewMatches PairTask::Describe(ImagePair pair, const PairMatches& verified, std::size_t putative_count) const {
  TwoViewMatches result;
  result.pair = pair;
  result.putative_count = static_cast<int>(putative_count);
  for (const FeatureMatch& match : verified.pairs) {
    result.matches.push_back({first.kept[match.first], second.kept[match.second]});
  }
  std::sort(result.matches.begin(), result.matches.end(),
            [](const FeatureMatch& a, const FeatureMatch& b) { return a.first < b.first; });
  const std::optional<Homography> plane = EstimateHomography(verified.points, max_error, seed);
  result.homography_inlier_share = plane ? plane->inlier_share : 0;
  return result;
}

}  // namespace drupe
