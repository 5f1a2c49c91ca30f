#include "reconstruction/matching/uncalibrated_matcher.h"

#include <numbers>

#include "reconstruction/matching/fundamental.h"
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
  explicit UncalibratedMatcher(const PairTask& task) : task_(task) {}

  std::optional<TwoViewMatches> Run(ImagePair pair) {
    const PairMatches putative = task_.Putative();
    if (!task_.IsEnough(putative)) return std::nullopt;
    const std::optional<FundamentalEstimate> estimate =
        EstimateFundamental(putative.points, task_.Ransac(task_.max_error));
    if (!estimate) return std::nullopt;
    PairMatches verified = putative.Subset(estimate->inliers);
    if (!task_.IsEnough(verified) || StandsStill(verified, task_.max_error)) return std::nullopt;
    std::optional<RelativePose> pose =
        EstimateRelativePose(verified.points, task_.Ransac(kGuessTolerance * task_.max_error));
    if (pose && task_.options.guided) {
      verified = Guide(verified, estimate->matrix, pose->second_from_first);
      if (!task_.IsEnough(verified)) return std::nullopt;
    }
    TwoViewMatches result = task_.Describe(pair, verified, putative.size());
    if (pose && !DescribePose(pose->second_from_first, verified, result)) return std::nullopt;
    return result;
  }

 private:
  PairMatches Guide(const PairMatches& verified, const Eigen::Matrix3d& fundamental, const Rigid3& pose) const {
    const EpipolarTransfer transfer = TransferFromFundamental(fundamental, pose);
    const PairMatches extended = task_.Guided(verified, transfer);
    const Eigen::Matrix3d refined = RefineFundamental(extended.points, task_.max_error, fundamental);
    return extended.Subset(InliersOf(refined, extended.points, task_.max_error));
  }

  /// Adds the pose when it explains enough. False for a pair without parallax.
  bool DescribePose(const Rigid3& start, const PairMatches& verified, TwoViewMatches& result) const {
    const double tolerance = kGuessTolerance * task_.max_error;
    const Rigid3 pose = RefineRelativePose(verified.points, tolerance, start);
    const auto explained = static_cast<int>(InliersOf(pose, verified.points, tolerance).size());
    if (explained < task_.options.min_inliers) return true;
    result.second_from_first = pose;
    result.calibrated = true;
    result.median_triangulation_angle_rad = MedianAngle(pose, verified);
    return result.median_triangulation_angle_rad >= task_.options.min_angle_deg * std::numbers::pi / 180;
  }

  PairTask task_;
};

}  // namespace

std::optional<TwoViewMatches> MatchUncalibratedPair(const PreparedPicture& first, const PreparedPicture& second,
                                                    ImagePair pair, double focal_px, const MatchingOptions& options,
                                                    std::uint64_t seed) {
  if (options.guessed_lens == GuessedLens::kFundamental) {
    return UncalibratedMatcher({first, second, options, options.max_error_px / focal_px, seed}).Run(pair);
  }
  MatchingOptions wider = options;
  wider.max_error_px *= kGuessTolerance;
  return MatchPair(first, second, pair, focal_px, wider, seed);
}

}  // namespace drupe
