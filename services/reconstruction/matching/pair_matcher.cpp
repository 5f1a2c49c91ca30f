#include "reconstruction/matching/pair_matcher.h"

#include <Eigen/Geometry>
#include <numbers>

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
  explicit PairMatcher(const PairTask& task) : task_(task) {}

  std::optional<TwoViewMatches> Run(ImagePair pair) {
    putative_ = task_.Putative();
    if (!task_.IsEnough(putative_)) return std::nullopt;
    const std::optional<RelativePose> sampled = EstimateRelativePose(putative_.points, task_.Ransac(task_.max_error));
    if (!sampled) return std::nullopt;
    Verified best{sampled->second_from_first, putative_.Subset(sampled->inliers)};
    if (StandsStill(best.matches, task_.max_error)) return std::nullopt;
    const std::vector<Rigid3> others = PlanarAlternatives(best.pose);
    const auto best_alone = static_cast<double>(best.matches.size());
    best = Guide(std::move(best));
    for (const Rigid3& pose : others) {
      // A plane's pose is less exact than RANSAC's: the first step takes in points from further away.
      Verified other = Verify(RefineRelativePose(putative_.points, 4 * task_.max_error, pose), putative_);
      if (other.matches.size() < kWorthGuiding * best_alone) continue;
      other = Guide(std::move(other));
      if (other.matches.size() > best.matches.size()) best = std::move(other);
    }
    if (!task_.IsEnough(best.matches)) return std::nullopt;
    const double angle = MedianAngle(best.pose, best.matches);
    if (angle < task_.options.min_angle_deg * std::numbers::pi / 180) return std::nullopt;
    return Describe(best, pair);
  }

 private:
  Verified Verify(const Rigid3& start, const PairMatches& matches) const {
    const Rigid3 pose = RefineRelativePose(matches.points, task_.max_error, start);
    return {pose, matches.Subset(InliersOf(pose, matches.points, task_.max_error))};
  }

  Verified Guide(Verified found) const {
    if (!task_.options.guided || !task_.IsEnough(found.matches)) return found;
    return Verify(found.pose, task_.Guided(found.matches, TransferFromPose(found.pose)));
  }

  /// Where nearly all matches lie in one plane, two poses explain them; RANSAC may have met the wrong one. Which it is,
  /// shows in the number of further matches.
  std::vector<Rigid3> PlanarAlternatives(const Rigid3& found) const {
    const std::optional<Homography> plane = EstimateHomography(putative_.points, task_.max_error, task_.seed);
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
    TwoViewMatches result = task_.Describe(pair, found.matches, putative_.size());
    result.second_from_first = found.pose;
    result.calibrated = true;
    result.median_triangulation_angle_rad = MedianAngle(found.pose, found.matches);
    return result;
  }

  PairTask task_;
  PairMatches putative_;
};

}  // namespace

std::optional<TwoViewMatches> MatchPair(const PreparedPicture& first, const PreparedPicture& second, ImagePair pair,
                                        double focal_px, const MatchingOptions& options, std::uint64_t seed) {
  return PairMatcher({first, second, options, options.max_error_px / focal_px, seed}).Run(pair);
}

}  // namespace drupe
