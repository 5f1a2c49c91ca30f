#include "reconstruction/sparse/initial_pair.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "reconstruction/sparse/bundle_adjustment.h"
#include "reconstruction/sparse/track_triangulation.h"

namespace drupe {
namespace {

constexpr int kMaxPairsTried = 20;
constexpr int kMinTracks = 30;          // positions after the first adjustment
constexpr double kMinAngleRad = 0.035;  // 2 degrees: below, depths are noise
constexpr double kGoodAngleRad = 0.14;  // 8 degrees: beyond, matches matter more than the angle
constexpr double kPlaneShare = 0.9;     // inliers of one homography: the scene is a plane, or there is no parallax
constexpr double kPlanePenalty = 0.1;

double Score(const TwoViewMatches& pair) {
  if (!pair.calibrated || pair.median_triangulation_angle_rad < kMinAngleRad) return 0;
  const double angle = std::min(1.0, pair.median_triangulation_angle_rad / kGoodAngleRad);
  const double flat = pair.homography_inlier_share > kPlaneShare ? kPlanePenalty : 1.0;
  return static_cast<double>(pair.matches.size()) * angle * flat;
}

/// Best first; ties in the order of the graph.
std::vector<const TwoViewMatches*> RankPairs(const MatchGraph& matches) {
  std::vector<const TwoViewMatches*> ranked;
  for (const TwoViewMatches& pair : matches.pairs) {
    if (Score(pair) > 0) ranked.push_back(&pair);
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](auto* a, auto* b) { return Score(*a) > Score(*b); });
  if (ranked.size() > kMaxPairsTried) ranked.resize(kMaxPairsTried);
  return ranked;
}

TriangulationOptions FirstTriangulation(const SparseOptions& options) {
  TriangulationOptions triangulation;
  triangulation.max_error_px = options.max_reprojection_error_px;
  triangulation.min_angle_rad = 0.5 * kMinAngleRad;
  return triangulation;
}

void Forget(SfmState& state) {
  for (auto& pose : state.poses) pose.reset();
  for (SfmTrack& track : state.tracks) track.has_position = false;
}

Result<int> TryPair(const TwoViewMatches& pair, const SparseOptions& options, const RunContext& context,
                    SfmState& state) {
  state.poses[pair.pair.first] = Rigid3{};
  state.poses[pair.pair.second] = pair.second_from_first;
  const TriangulationOptions triangulation = FirstTriangulation(options);
  DRUPE_RETURN_IF_ERROR(UpdateTracks(state, triangulation, context));
  if (CountPositions(state) < kMinTracks) return 0;
  AdjustmentOptions adjustment;
  adjustment.method = options.adjustment;
  DRUPE_RETURN_IF_ERROR(AdjustBundle(state, AdjustmentScope::Everything(state), adjustment, context));
  DRUPE_RETURN_IF_ERROR(UpdateTracks(state, triangulation, context));
  return CountPositions(state);
}

}  // namespace

Status StartFromPair(const MatchGraph& matches, const SparseOptions& options, const RunContext& context,
                     SfmState& state) {
  for (const TwoViewMatches* pair : RankPairs(matches)) {
    Forget(state);
    DRUPE_ASSIGN_OR_RETURN(const int tracks, TryPair(*pair, options, context, state));
    if (tracks >= kMinTracks) return Status::Ok();
  }
  Forget(state);
  const bool is_calibrated = std::any_of(matches.pairs.begin(), matches.pairs.end(),
                                         [](const TwoViewMatches& pair) { return pair.calibrated; });
  if (!is_calibrated && !matches.pairs.empty()) {
    return Unprocessable(
        "no_initial_pair",
        "nothing is known about the lens, so two pictures alone do not show how the camera moved; give "
        "a calibration, or keep the board in view");
  }
  return Unprocessable("no_initial_pair",
                       "no two pictures share enough features seen under different angles to begin with; use more "
                       "pictures with smaller turns between them (10 degrees or less), a textured base or board under "
                       "the fruit, and sharp, evenly lit pictures");
}

}  // namespace drupe
