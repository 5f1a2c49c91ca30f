#include "reconstruction/matching/pair_matcher.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruction/matching/descriptor_matching.h"
#include "reconstruction/matching/guided.h"
#include "reconstruction/matching/homography.h"
#include "reconstruction/matching/relative_pose.h"

namespace drupe {
namespace {

/// From this share of matches in one plane on, the plane's second pose is tried too.
constexpr double kPlanarShare = 0.5;
/// A second pose that verifies less than this share of what the first one does is not pursued.
constexpr double kWorthGuiding = 0.8;
/// How much further apart (squared) the looks of further matches may be than those of most verified ones: these are the
/// coarsest features, and finer ones look less alike.
constexpr double kLookMargin = 2.5;
/// Two poses that differ by less are one.
constexpr double kSameRotation = 0.005;

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
  guide.max_squared_distance = static_cast<std::int32_t>(kLookMargin * Quantile(distances, 0.95));
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
  if (matches.points.empty()) return false;
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

/// A pose and what it verifies.
struct Verified {
  Rigid3 pose;
  Matches matches;
};

/// Matches one pair, step by step.
class PairMatcher {
 public:
  PairMatcher(const PreparedPicture& first, const PreparedPicture& second, double focal_px,
              const MatchingOptions& options, std::uint64_t seed)
      : first_(first), second_(second), options_(options), max_error_(options.max_error_px / focal_px), seed_(seed) {}

  std::optional<TwoViewMatches> Run(ImagePair pair) {
    for (const FeatureMatch& match : MatchDescriptors(first_, second_, options_.max_ratio)) {
      putative_.Add(match, first_, second_);
    }
    if (!IsEnough(putative_)) return std::nullopt;
    const std::optional<RelativePose> sampled =
        EstimateRelativePose(putative_.points, {max_error_, options_.confidence, options_.max_iterations, seed_});
    if (!sampled) return std::nullopt;
    Verified best{sampled->second_from_first, putative_.Subset(sampled->inliers)};
    if (StandsStill(best.matches, max_error_)) return std::nullopt;
    const std::vector<Rigid3> others = PlanarAlternatives(best.pose);
    const auto best_alone = static_cast<double>(best.matches.pairs.size());
    best = Guide(std::move(best));
    for (const Rigid3& pose : others) {
      // A plane's pose is less exact than RANSAC's: the first step takes in points from further away.
      Verified other = Verify(RefineRelativePose(putative_.points, 4 * max_error_, pose), putative_);
      if (other.matches.pairs.size() < kWorthGuiding * best_alone) continue;
      other = Guide(std::move(other));
      if (other.matches.pairs.size() > best.matches.pairs.size()) best = std::move(other);
    }
    if (!IsEnough(best.matches)) return std::nullopt;
    const double angle = MedianAngle(best.pose, best.matches);
    if (angle < options_.min_angle_deg * std::numbers::pi / 180) return std::nullopt;
    return Describe(best, pair);
  }

 private:
  bool IsEnough(const Matches& matches) const { return static_cast<int>(matches.pairs.size()) >= options_.min_inliers; }

  Verified Verify(const Rigid3& start, const Matches& matches) const {
    const Rigid3 pose = RefineRelativePose(matches.points, max_error_, start);
    return {pose, matches.Subset(InliersOf(pose, matches.points, max_error_))};
  }

  Verified Guide(Verified found) const {
    if (!options_.guided || !IsEnough(found.matches)) return found;
    const GuidedOptions guide =
        GuideFrom(found.matches, first_, second_, found.pose, max_error_, options_.guided_max_ratio);
    const std::vector<FeatureMatch> guided = MatchGuided(first_, second_, found.pose, guide);
    return Verify(found.pose, Extended(found.matches, guided, first_, second_));
  }

  /// Where nearly all matches lie in one plane, two poses explain them; RANSAC may have met the wrong one. Which it is,
  /// shows in the number of further matches.
  std::vector<Rigid3> PlanarAlternatives(const Rigid3& found) const {
    const std::optional<Homography> plane = EstimateHomography(putative_.points, max_error_, seed_);
    if (!plane || plane->inlier_share < kPlanarShare) return {};
    std::vector<Rigid3> others;
    for (const Rigid3& pose : PosesFromHomography(plane->matrix)) {
      const double turned = Eigen::AngleAxisd(found.rotation.transpose() * pose.rotation).angle();
      if (turned < kSameRotation) continue;
      others.push_back(pose);
      others.push_back({pose.rotation, -pose.translation});
    }
    return others;
  }

  TwoViewMatches Describe(const Verified& found, ImagePair pair) const {
    TwoViewMatches result;
    result.pair = pair;
    result.matches = ByKeypoint(found.matches, first_, second_);
    result.putative_count = static_cast<int>(putative_.pairs.size());
    result.second_from_first = found.pose;
    result.calibrated = true;
    result.median_triangulation_angle_rad = MedianAngle(found.pose, found.matches);
    const std::optional<Homography> plane = EstimateHomography(found.matches.points, max_error_, seed_);
    result.homography_inlier_share = plane ? plane->inlier_share : 0;
    return result;
  }

  const PreparedPicture& first_;
  const PreparedPicture& second_;
  const MatchingOptions& options_;
  double max_error_;
  std::uint64_t seed_;
  Matches putative_;
};

}  // namespace

std::optional<TwoViewMatches> MatchPair(const PreparedPicture& first, const PreparedPicture& second, ImagePair pair,
                                        double focal_px, const MatchingOptions& options, std::uint64_t seed) {
  return PairMatcher(first, second, focal_px, options, seed).Run(pair);
}

}  // namespace drupe
