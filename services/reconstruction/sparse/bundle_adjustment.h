#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// How an adjustment weighs what it adjusts. Residuals are whitened by the standard deviations; the Cauchy losses have
/// the given scales in pixels.
struct AdjustmentOptions {
  double feature_sigma_px = 0.5;
  double board_sigma_px = 0.1;
  double feature_loss_px = 1.0;
  double board_loss_px = 0.5;
  int max_iterations = 20;
  double function_tolerance = 1e-6;  ///< relative decrease of the cost at which to stop
  /// Stop too when a step moves the views' parameters by less than this in the root mean square, in units of their own
  /// standard deviations: single tracks between contradicting observations may go on for long. Of kDistributed alone.
  double pose_tolerance_sigmas = 0;
  bool refine_intrinsics = false;  ///< focal length, k1, k2; state.camera is replaced; always monolithic
  AdjustmentMethod method = AdjustmentMethod::kDistributed;
};

/// What an adjustment moves.
struct AdjustmentScope {
  /// Per view: 1 moves. Registered views that do not move still hold the tracks that both see.
  std::vector<std::uint8_t> view_moves;

  /// Every registered view.
  static AdjustmentScope Everything(const SfmState& state);
};

/// Bundle adjustment of poses, tracks with a position and, in a metric state, the board's ink spread, against active
/// observations and board corners, by AdjustDistributed or AdjustMonolithic. The gauge is the board in a metric state;
/// otherwise the first registered view does not move. Errors: `cancelled`, 500 `adjustment_failed`. While intrinsics
/// are refined the ink spread stays as it is.
Status AdjustBundle(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options,
                    const RunContext& context);

/// The cost that both methods bring down: half the sum of the losses of active observations and, in a metric state,
/// board corners.
double AdjustmentCost(const SfmState& state, const AdjustmentOptions& options);

/// Robust standard deviations (1.4826 times the median absolute deviation, per coordinate) of whitened features and of
/// board corners, pixels; 0 where there are none.
struct NoiseLevels {
  double feature_px = 0;
  double board_px = 0;
};
NoiseLevels EstimateNoise(const SfmState& state);

}  // namespace drupe
