#include "reconstruction/matching/uncalibrated_matcher.h"

#include <numbers>

#include "reconstruction/matching/fundamental.h"
#include "reconstruction/matching/guided.h"
#include "reconstruction/matching/pair_matcher.h"
#include "reconstruction/matching/pair_matches.h"
#include "reconstruction/matching/relative_pose.h"

namespace drupe {
namespace {

/// Epipolar lines of an essential matrix are off by several pixels while the focal length is a guess.
constexpr double kGuessTolerance = 3.0;

/// Matches one pair, step by step.
class UncalibratedMatcher {
 public:
  UncalibratedMatcher(const PreparedPicture& first, const PreparedPicture& second, double focal_px,
                      const MatchingOptions& options, std::uint64_t seed)
      : first_(first), second_(second), options_(options), max_error_(options.max_error_px / focal_px), seed_(seed) {}

  std::optional<TwoViewMatches> Run(ImagePair pair) {
    const PairMatches putative = PutativeMatches(first_, second_, options_.max_ratio);
    if (!IsEnough(putative)) return std::nullopt;
    const std::optional<FundamentalEstimate> estimate = EstimateFundamental(putative.points, Ransac(max_error_));
    if (!estimate) return std::nullopt;
    PairMatches verified = putative.Subset(estimate->inliers);
    if (!IsEnough(verified) || StandsStill(verified, max_error_)) return std::nullopt;
    std::optional<RelativePose> pose = EstimateRelativePose(verified.points, Ransac(kGuessTolerance * max_error_));
    if (pose && options_.guided) {
      verified = Guide(verified, estimate->matrix, pose->second_from_first);
      if (!IsEnough(verified)) return std::nullopt;
    }
    TwoViewMatches result = DescribePair(pair, verified, first_, second_, max_error_, seed_);
    result.putative_count = static_cast<int>(putative.size());
    if (pose && !DescribePose(pose->second_from_first, verified, result)) return std::nullopt;
    return result;
  }

 private:
  bool IsEnough(const PairMatches& matches) const { return static_cast<int>(matches.size()) >= options_.min_inliers; }
  RansacOptions Ransac(double max_error) const {
    return {max_error, options_.confidence, options_.max_iterations, seed_};
  }

  PairMatches Guide(const PairMatches& verified, const Eigen::Matrix3d& fundamental, const Rigid3& pose) const {
    const EpipolarTransfer transfer = TransferFromFundamental(fundamental, pose);
    const GuidedOptions guide = GuideFrom(verified, first_, second_, transfer, max_error_, options_.guided_max_ratio);
    const PairMatches extended = Extended(verified, MatchGuided(first_, second_, transfer, guide), first_, second_);
    const Eigen::Matrix3d refined = RefineFundamental(extended.points, max_error_, fundamental);
    return extended.Subset(InliersOf(refined, extended.points, max_error_));
  }

  /// Adds the pose when it explains enough. False for a pair without parallax.
  bool DescribePose(const Rigid3& start, const PairMatches& verified, TwoViewMatches& result) const {
    const double tolerance = kGuessTolerance * max_error_;
    const Rigid3 pose = RefineRelativePose(verified.points, tolerance, start);
    const auto explained = static_cast<int>(InliersOf(pose, verified.points, tolerance).size());
    if (explained < options_.min_inliers) return true;
    result.second_from_first = pose;
    result.calibrated = true;
    result.median_triangulation_angle_rad = MedianAngle(pose, verified);
    return result.median_triangulation_angle_rad >= options_.min_angle_deg * std::numbers::pi / 180;
  }

  const PreparedPicture& first_;
  const PreparedPicture& second_;
  const MatchingOptions& options_;
  double max_error_;
  std::uint64_t seed_;
};

}  // namespace

std::optional<TwoViewMatches> MatchUncalibratedPair(const PreparedPicture& first, const PreparedPicture& second,
                                                    ImagePair pair, double focal_px, const MatchingOptions& options,
                                                    std::uint64_t seed) {
  if (options.guessed_lens == GuessedLens::kFundamental) {
    return UncalibratedMatcher(first, second, focal_px, options, seed).Run(pair);
  }
  MatchingOptions wider = options;
  wider.max_error_px *= kGuessTolerance;
  return MatchPair(first, second, pair, focal_px, wider, seed);
}

}  // namespace drupe
