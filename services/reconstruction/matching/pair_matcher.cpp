#include "reconstruction/matching/pair_matcher.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reconstruction/matching/guided.h"
#include "reconstruction/matching/homography.h"
#include "reconstruction/matching/relative_pose.h"

namespace drupe {
namespace {

/// Matches by places in `kept`, with the coordinates of both ends.
struct Matches {
  std::vector<FeatureMatch> pairs;
  std::vector<PointPair> points;

  void Add(FeatureMatch match, const PreparedPicture& first, const PreparedPicture& second) {
    pairs.push_back(match);
    points.push_back({first.places[match.first], second.places[match.second]});
  }
  Matches Subset(const std::vector<int>& indices) const {
    Matches subset;
    for (const int i : indices) {
      subset.pairs.push_back(pairs[i]);
      subset.points.push_back(points[i]);
    }
    return subset;
  }
};

/// The value below which `share` of the values lie; `values` not empty.
template <typename T>
T Quantile(std::vector<T> values, double share) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// All with all, ratio test and mutual check.
Matches MatchExhaustively(const PreparedPicture& first, const PreparedPicture& second, double max_ratio) {
  std::vector<std::uint32_t> queries(first.packed.size());
  std::iota(queries.begin(), queries.end(), 0u);
  const std::vector<Nearest> forward = FindNearest(first.packed, queries, second.packed);
  // The way back is asked of the few that pass alone.
  std::vector<std::uint32_t> passed, partners;
  for (std::uint32_t i = 0; i < forward.size(); ++i) {
    if (!forward[i].Passes(max_ratio)) continue;
    passed.push_back(i);
    partners.push_back(static_cast<std::uint32_t>(forward[i].index));
  }
  const std::vector<Nearest> backward = FindNearest(second.packed, partners, first.packed);
  Matches matches;
  for (std::size_t k = 0; k < passed.size(); ++k) {
    if (backward[k].index == static_cast<std::int32_t>(passed[k])) {
      matches.Add({passed[k], partners[k]}, first, second);
    }
  }
  return matches;
}

/// What the verified matches say about where further ones can lie.
GuidedOptions GuideFrom(const Matches& verified, const PreparedPicture& first, const PreparedPicture& second,
                        const Rigid3& pose, double max_error, double max_ratio) {
  std::vector<double> inverse_depths;
  std::vector<std::int32_t> distances;
  for (std::size_t i = 0; i < verified.pairs.size(); ++i) {
    const double depth = DepthsOf(pose, verified.points[i]).x();
    inverse_depths.push_back(depth > 0 ? 1 / depth : 0);
    const FeatureMatch& match = verified.pairs[i];
    distances.push_back(SquaredDistance(first.Descriptor(match.first), second.Descriptor(match.second)));
  }
  GuidedOptions guide;
  guide.max_error = max_error;
  guide.max_ratio = max_ratio;
  const double low = Quantile(inverse_depths, 0.01), high = Quantile(inverse_depths, 0.99);
  const double margin = 0.25 * (high - low);
  guide.inverse_depth_min = std::max(0.0, low - margin);
  guide.inverse_depth_max = high + margin;
  guide.max_squared_distance = Quantile(distances, 0.95);
  return guide;
}

/// The verified matches and, of the guided ones, those between features that have none yet.
Matches Extended(const Matches& verified, const std::vector<FeatureMatch>& guided, const PreparedPicture& first,
                 const PreparedPicture& second) {
  std::vector<bool> used_first(first.kept.size()), used_second(second.kept.size());
  for (const FeatureMatch& match : verified.pairs) used_first[match.first] = used_second[match.second] = true;
  Matches extended = verified;
  for (const FeatureMatch& match : guided) {
    if (!used_first[match.first] && !used_second[match.second]) extended.Add(match, first, second);
  }
  return extended;
}

/// True when the middle match moves less than the error: then nothing turned between the pictures.
bool StandsStill(const Matches& matches, double max_error) {
  std::vector<double> moved;
  for (const PointPair& points : matches.points) moved.push_back((points.first - points.second).norm());
  return Quantile(moved, 0.5) < max_error;
}

double MedianAngle(const Rigid3& pose, const Matches& matches) {
  std::vector<double> angles;
  for (const PointPair& points : matches.points) angles.push_back(TriangulationAngle(pose, points));
  return Quantile(angles, 0.5);
}

std::vector<FeatureMatch> ByKeypoint(const Matches& matches, const PreparedPicture& first,
                                     const PreparedPicture& second) {
  std::vector<FeatureMatch> named;
  for (const FeatureMatch& match : matches.pairs) named.push_back({first.kept[match.first], second.kept[match.second]});
  std::sort(named.begin(), named.end(), [](const FeatureMatch& a, const FeatureMatch& b) { return a.first < b.first; });
  return named;
}

}  // namespace

std::optional<TwoViewMatches> MatchPair(const PreparedPicture& first, const PreparedPicture& second, ImagePair pair,
                                        double focal_px, const MatchingOptions& options, std::uint64_t seed) {
  const double max_error = options.max_error_px / focal_px;
  const Matches putative = MatchExhaustively(first, second, options.max_ratio);
  const auto is_enough = [&](std::size_t count) { return static_cast<int>(count) >= options.min_inliers; };
  if (!is_enough(putative.pairs.size())) return std::nullopt;
  const RansacOptions ransac{max_error, options.confidence, options.max_iterations, seed};
  std::optional<RelativePose> pose = EstimateRelativePose(putative.points, ransac);
  if (!pose || !is_enough(pose->inliers.size())) return std::nullopt;
  Matches verified = putative.Subset(pose->inliers);
  if (StandsStill(verified, max_error)) return std::nullopt;
  if (options.guided) {
    const GuidedOptions guide =
        GuideFrom(verified, first, second, pose->second_from_first, max_error, options.guided_max_ratio);
    const Matches extended =
        Extended(verified, MatchGuided(first, second, pose->second_from_first, guide), first, second);
    pose->second_from_first = RefineRelativePose(extended.points, max_error, pose->second_from_first);
    verified = extended.Subset(InliersOf(pose->second_from_first, extended.points, max_error));
    if (!is_enough(verified.pairs.size())) return std::nullopt;
  }
  TwoViewMatches result;
  result.pair = pair;
  result.matches = ByKeypoint(verified, first, second);
  result.putative_count = static_cast<int>(putative.pairs.size());
  result.second_from_first = pose->second_from_first;
  result.calibrated = true;
  result.median_triangulation_angle_rad = MedianAngle(pose->second_from_first, verified);
  result.homography_inlier_share = HomographyInlierShare(verified.points, max_error, seed);
  return result;
}

}  // namespace drupe
