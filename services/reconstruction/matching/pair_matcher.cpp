#include "reconstruction/matching/pair_matcher.h"

#include <Eigen/Geometry>
#include <numbers>

#include "reconstruction/matching/guided.h"
#include "reconstruction/matching/homography.h"
#include "reconstruction/matching/pair_matches.h"
#include "reconstruction/matching/relative_pose.h"

namespace drupe {
namespace {

/// From this share of matches in one plane on, the plane's second pose is tried too.
constexpr double kPlanarShare = 0.5;
/// A second pose that verifies less than this share of what the first one does is not pursued.
constexpr double kWorthGuiding = 0.8;
/// Two poses that differ by less are one.
constexpr double kSameRotation = 0.005;

/// A pose and what it verifies.
struct Verified {
  Rigid3 pose;
  PairMatches matches;
};

/// Matches one pair, step by step.
class PairMatcher {
 public:
  PairMatcher(const PreparedPicture& first, const PreparedPicture& second, double focal_px,
              const MatchingOptions& options, std::uint64_t seed)
      : first_(first), second_(second), options_(options), max_error_(options.max_error_px / focal_px), seed_(seed) {}

  std::optional<TwoViewMatches> Run(ImagePair pair) {
    putative_ = PutativeMatches(first_, second_, options_.max_ratio);
    if (!IsEnough(putative_)) return std::nullopt;
    const std::optional<RelativePose> sampled =
        EstimateRelativePose(putative_.points, {max_error_, options_.confidence, options_.max_iterations, seed_});
    if (!sampled) return std::nullopt;
    Verified best{sampled->second_from_first, putative_.Subset(sampled->inliers)};
    if (StandsStill(best.matches, max_error_)) return std::nullopt;
    const std::vector<Rigid3> others = PlanarAlternatives(best.pose);
    const auto best_alone = static_cast<double>(best.matches.size());
    best = Guide(std::move(best));
    for (const Rigid3& pose : others) {
      // A plane's pose is less exact than RANSAC's: the first step takes in points from further away.
      Verified other = Verify(RefineRelativePose(putative_.points, 4 * max_error_, pose), putative_);
      if (other.matches.size() < kWorthGuiding * best_alone) continue;
      other = Guide(std::move(other));
      if (other.matches.size() > best.matches.size()) best = std::move(other);
    }
    if (!IsEnough(best.matches)) return std::nullopt;
    const double angle = MedianAngle(best.pose, best.matches);
    if (angle < options_.min_angle_deg * std::numbers::pi / 180) return std::nullopt;
    return Describe(best, pair);
  }

 private:
  bool IsEnough(const PairMatches& matches) const { return static_cast<int>(matches.size()) >= options_.min_inliers; }

  Verified Verify(const Rigid3& start, const PairMatches& matches) const {
    const Rigid3 pose = RefineRelativePose(matches.points, max_error_, start);
    return {pose, matches.Subset(InliersOf(pose, matches.points, max_error_))};
  }

  Verified Guide(Verified found) const {
    if (!options_.guided || !IsEnough(found.matches)) return found;
    const EpipolarTransfer transfer = TransferFromPose(found.pose);
    const GuidedOptions guide =
        GuideFrom(found.matches, first_, second_, transfer, max_error_, options_.guided_max_ratio);
    const std::vector<FeatureMatch> guided = MatchGuided(first_, second_, transfer, guide);
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
    TwoViewMatches result = DescribePair(pair, found.matches, first_, second_, max_error_, seed_);
    result.putative_count = static_cast<int>(putative_.size());
    result.second_from_first = found.pose;
    result.calibrated = true;
    result.median_triangulation_angle_rad = MedianAngle(found.pose, found.matches);
    return result;
  }

  const PreparedPicture& first_;
  const PreparedPicture& second_;
  const MatchingOptions& options_;
  double max_error_;
  std::uint64_t seed_;
  PairMatches putative_;
};

}  // namespace

std::optional<TwoViewMatches> MatchPair(const PreparedPicture& first, const PreparedPicture& second, ImagePair pair,
                                        double focal_px, const MatchingOptions& options, std::uint64_t seed) {
  return PairMatcher(first, second, focal_px, options, seed).Run(pair);
}

}  // namespace drupe
