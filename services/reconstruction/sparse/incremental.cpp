#include "reconstruction/sparse/incremental.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "reconstruction/sparse/pose_estimation.h"
#include "reconstruction/sparse/stray_tracks.h"
#include "reconstruction/sparse/track_completion.h"
#include "reconstruction/sparse/track_triangulation.h"

namespace drupe {
namespace {

constexpr std::size_t kLocalViews = 6;  // adjusted together with a new view
constexpr double kGlobalGrowth = 1.25;  // everything is adjusted whenever the model has grown by this
constexpr double kRetryGrowth = 1.2;    // a failed view is tried again when it sees this many times the tracks
constexpr double kGateSigmas = 6.0;     // observations farther off than this many sigmas are wrong
constexpr double kMinGatePx = 1.0;
constexpr double kCompletionSigmas = 3.0;  // what nobody has matched must lie closer
constexpr double kLossSigmas = 2.385;      // scale of Cauchy's loss that keeps 95 % of the efficiency (Zhang 1997)
constexpr double kRoughSigmas = 0.03;  // of a step of the poses, after which an adjustment that others follow ends, ...
constexpr double kFinalSigmas = 0.003;  // ... and the last one
constexpr int kMostCameraRounds = 12;
constexpr double kCameraRests = 1e-4;  // relative change of the focal length in a round, below which it has settled
constexpr double kMinNoisePx = 0.02;   // a noise below is not believed: it would switch the other kind off

TriangulationOptions TriangulationFrom(const SparseOptions& options) {
  TriangulationOptions triangulation;
  triangulation.max_error_px = options.max_reprojection_error_px;
  triangulation.min_angle_rad = options.min_triangulation_angle_deg * std::numbers::pi / 180;
  return triangulation;
}

int CountVisibleTracks(const SfmState& state, int view) {
  const auto& seen = state.view_observations[view];
  return static_cast<int>(std::count_if(
      seen.begin(), seen.end(), [&](std::size_t o) { return state.tracks[state.observations[o].track].has_position; }));
}

bool SeesEnoughBoard(const SfmState& state, int view, const SparseOptions& options) {
  return state.is_metric && static_cast<int>(state.board_corners[view].size()) >= options.min_board_corners;
}

/// Sets the view's pose from the tracks it sees, or the reason why there is none.
bool PlaceByFeatures(int view, const SparseOptions& options, std::uint64_t seed, SfmState& state) {
  std::vector<PointCorrespondence> correspondences;
  for (std::size_t o : state.view_observations[view]) {
    const SfmObservation& observation = state.observations[o];
    const SfmTrack& track = state.tracks[observation.track];
    if (track.has_position) correspondences.push_back({track.position, observation.measured.xy});
  }
  const int seen = static_cast<int>(correspondences.size());
  if (seen < options.min_pnp_inliers) {
    state.reasons[view] = "shares " + std::to_string(seen) + " points with the other pictures, " +
                          std::to_string(options.min_pnp_inliers) + " are needed";
    return false;
  }
  PoseEstimationOptions estimation;
  estimation.max_error = options.max_reprojection_error_px / state.FocalPx();
  estimation.max_iterations = options.max_ransac_iterations;
  estimation.seed = seed + static_cast<std::uint64_t>(view);
  const auto estimate = EstimatePose(correspondences, estimation);
  if (!estimate || estimate->inlier_count < options.min_pnp_inliers) {
    state.reasons[view] =
        "no position explains what it sees: " + std::to_string(estimate ? estimate->inlier_count : 0) + " of " +
        std::to_string(seen) + " points agree, " + std::to_string(options.min_pnp_inliers) + " are needed";
    return false;
  }
  state.poses[view] = estimate->cam_from_world;
  state.reasons[view].clear();
  return true;
}

bool PlaceByBoard(int view, const std::vector<std::optional<Rigid3>>& board_poses, SfmState& state) {
  if (!state.is_metric || !board_poses[view]) return false;
  state.poses[view] = board_poses[view];
  state.reasons[view].clear();
  return true;
}

/// A view and those that share most active tracks with it.
AdjustmentScope Neighbourhood(const SfmState& state, int view) {
  std::vector<int> shared(state.ViewCount(), 0);
  for (std::size_t o : state.view_observations[view]) {
    if (!state.observations[o].is_active) continue;
    for (const SfmObservation& other : state.ObservationsOf(state.tracks[state.observations[o].track])) {
      if (other.is_active && other.view != view) ++shared[other.view];
    }
  }
  std::vector<int> order(state.ViewCount());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return shared[a] > shared[b]; });
  AdjustmentScope scope;
  scope.view_moves.assign(state.ViewCount(), 0);
  scope.view_moves[view] = 1;
  for (std::size_t k = 0; k < kLocalViews && k < order.size() && shared[order[k]] > 0; ++k) {
    scope.view_moves[order[k]] = 1;
  }
  return scope;
}

/// Growth of one model: which views wait, and what was tried.
class Growth {
 public:
  Growth(const std::vector<std::optional<Rigid3>>& board_poses, const SparseOptions& options, const RunContext& context,
         SfmState& state)
      : board_poses_(board_poses),
        options_(options),
        context_(context),
        state_(state),
        visible_when_failed_(state.ViewCount(), 0),
        last_global_count_(state.RegisteredCount()) {}

  Status Run() {
    DRUPE_RETURN_IF_ERROR(UpdateTracks(state_, TriangulationFrom(options_), context_));
    while (true) {
      DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
      const int view = PlaceNext();
      if (view < 0) return Status::Ok();
      DRUPE_RETURN_IF_ERROR(Settle(view));
      context_.Report("sparse", 0.1 + 0.6 * state_.RegisteredCount() / state_.ViewCount());
    }
  }

 private:
  /// Waiting views, those that see most first.
  std::vector<std::pair<int, int>> Candidates() const {
    std::vector<std::pair<int, int>> candidates;  // tracks seen, view
    for (int v = 0; v < state_.ViewCount(); ++v) {
      if (state_.poses[v]) continue;
      const int visible = CountVisibleTracks(state_, v);
      const bool is_new = visible_when_failed_[v] == 0 || visible >= kRetryGrowth * visible_when_failed_[v];
      if (is_new) candidates.emplace_back(visible, v);
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](auto a, auto b) { return a.first > b.first; });
    return candidates;
  }

  /// The view that was placed, or -1 when none can be.
  int PlaceNext() {
    for (const auto& [visible, view] : Candidates()) {
      if (PlaceByFeatures(view, options_, context_.seed, state_)) return view;
      if (PlaceByBoard(view, board_poses_, state_)) return view;
      visible_when_failed_[view] = std::max(1, visible);
    }
    return -1;
  }

  Status Settle(int view) {
    const TriangulationOptions triangulation = TriangulationFrom(options_);
    DRUPE_RETURN_IF_ERROR(UpdateTracks(state_, triangulation, context_));
    AdjustmentOptions adjustment = LossesFrom(options_);
    adjustment.max_iterations = 10;
    adjustment.function_tolerance = 1e-4;
    const bool is_global = state_.RegisteredCount() >= kGlobalGrowth * last_global_count_;
    if (is_global) last_global_count_ = state_.RegisteredCount();
    const AdjustmentScope scope = is_global ? AdjustmentScope::Everything(state_) : Neighbourhood(state_, view);
    DRUPE_RETURN_IF_ERROR(AdjustBundle(state_, scope, adjustment, context_));
    return UpdateTracks(state_, triangulation, context_);
  }

  const std::vector<std::optional<Rigid3>>& board_poses_;
  const SparseOptions& options_;
  const RunContext& context_;
  SfmState& state_;
  std::vector<int> visible_when_failed_;  // 0: not tried
  int last_global_count_;
};

/// Takes out the views that the last clean-up left with too little. True when there was one.
bool DropWeakViews(const SparseOptions& options, SfmState& state) {
  std::vector<int> active(state.ViewCount(), 0);
  for (const SfmObservation& observation : state.observations) active[observation.view] += observation.is_active;
  bool dropped = false;
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!state.poses[v] || active[v] >= options.min_pnp_inliers || SeesEnoughBoard(state, v, options)) continue;
    state.poses[v].reset();
    state.reasons[v] = "only " + std::to_string(active[v]) + " of its points agree with the other pictures, " +
                       std::to_string(options.min_pnp_inliers) + " are needed";
    dropped = true;
  }
  return dropped;
}

/// The last rounds of adjustment and clean-up; each weighs by the noise that the one before found.
class Finish {
 public:
  Finish(const SparseInput& input, const SparseOptions& options, const RunContext& context, SfmState& state)
      : input_(input),
        options_(options),
        context_(context),
        state_(state),
        triangulation_(TriangulationFrom(options)),
        adjustment_(LossesFrom(options)) {
    adjustment_.refine_intrinsics = input.refine_intrinsics;
  }

  Result<NoiseLevels> Run() {
    DRUPE_RETURN_IF_ERROR(SettleCamera());
    context_.Report("sparse", 0.85);
    if (options_.complete_tracks) DRUPE_RETURN_IF_ERROR(Complete());
    adjustment_.function_tolerance = 1e-7;
    adjustment_.pose_tolerance_sigmas = kFinalSigmas;
    DRUPE_RETURN_IF_ERROR(Round());
    context_.Report("sparse", 1);
    return noise_;
  }

 private:
  /// One round; where the intrinsics are refined as many as they move in: a better camera brings back observations,
  /// which make a better camera.
  Status SettleCamera() {
    adjustment_.function_tolerance = 1e-4;
    adjustment_.pose_tolerance_sigmas = kRoughSigmas;
    for (int round = 0; round < kMostCameraRounds; ++round) {
      const double focal = state_.FocalPx();
      DRUPE_RETURN_IF_ERROR(Round());
      if (!input_.refine_intrinsics || std::abs(state_.FocalPx() / focal - 1) < kCameraRests) break;
    }
    return Status::Ok();
  }

  Status Round() {
    DRUPE_RETURN_IF_ERROR(AdjustBundle(state_, AdjustmentScope::Everything(state_), adjustment_, context_));
    noise_ = EstimateNoise(state_);
    adjustment_.feature_sigma_px = std::max(kMinNoisePx, noise_.feature_px);
    adjustment_.feature_loss_px = std::min(options_.feature_loss_px, kLossSigmas * adjustment_.feature_sigma_px);
    adjustment_.board_sigma_px = std::max(kMinNoisePx, noise_.board_px);
    triangulation_.max_error_px =
        std::min(options_.max_reprojection_error_px, std::max(kMinGatePx, kGateSigmas * noise_.feature_px));
    DRUPE_RETURN_IF_ERROR(UpdateTracks(state_, triangulation_, context_));
    if (DropWeakViews(options_, state_)) DRUPE_RETURN_IF_ERROR(UpdateTracks(state_, triangulation_, context_));
    DropStrayTracks(state_);
    return Status::Ok();
  }

  Status Complete() {
    const double max_error_px = kCompletionSigmas * adjustment_.feature_sigma_px;
    return CompleteTracks(input_.features, input_.matches->is_static, max_error_px, context_, state_).status();
  }

  const SparseInput& input_;
  const SparseOptions& options_;
  const RunContext& context_;
  SfmState& state_;
  TriangulationOptions triangulation_;
  AdjustmentOptions adjustment_;
  NoiseLevels noise_;
};

}  // namespace

AdjustmentOptions LossesFrom(const SparseOptions& options) {
  AdjustmentOptions adjustment;
  adjustment.feature_loss_px = options.feature_loss_px;
  adjustment.board_loss_px = options.board_loss_px;
  adjustment.method = options.adjustment;
  return adjustment;
}

Status GrowModel(const std::vector<std::optional<Rigid3>>& board_poses, const SparseOptions& options,
                 const RunContext& context, SfmState& state) {
  return Growth(board_poses, options, context, state).Run();
}

Status SettleModel(const SparseOptions& options, const RunContext& context, SfmState& state) {
  AdjustmentOptions adjustment = LossesFrom(options);
  adjustment.max_iterations = 10;
  adjustment.function_tolerance = 1e-3;
  DRUPE_RETURN_IF_ERROR(AdjustBundle(state, AdjustmentScope::Everything(state), adjustment, context));
  return UpdateTracks(state, TriangulationFrom(options), context);
}

Status CloseSeams(const SparseOptions& options, const RunContext& context, SfmState& state) {
  for (const double widening : {8.0, 2.0}) {
    TriangulationOptions triangulation = TriangulationFrom(options);
    triangulation.max_error_px *= widening;
    DRUPE_RETURN_IF_ERROR(UpdateTracks(state, triangulation, context));
    DRUPE_RETURN_IF_ERROR(SettleModel(options, context, state));
  }
  return Status::Ok();
}

Result<NoiseLevels> FinishModel(const SparseInput& input, const SparseOptions& options, const RunContext& context,
                                SfmState& state) {
  return Finish(input, options, context, state).Run();
}

}  // namespace drupe
