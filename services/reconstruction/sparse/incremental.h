#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/bundle_adjustment.h"
#include "reconstruction/sparse/sfm_state.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// The adjustment's losses and method that the options ask for, with the noise still to be estimated.
AdjustmentOptions LossesFrom(const SparseOptions& options);

/// Adds view after view to a state that has some: the one that sees most tracks with a position comes next (paper
/// 3.1.2 (4)), its pose from these, then new tracks, a local adjustment, and from time to time an adjustment of
/// everything. `board_poses` place views that features cannot, in a metric state. Ends when no view can be added; those
/// left have their reason. Errors: `cancelled`, 500 `adjustment_failed`.
Status GrowModel(const std::vector<std::optional<Rigid3>>& board_poses, const SparseOptions& options,
                 const RunContext& context, SfmState& state);

/// Adjusts a grown model as a whole, roughly, and brings its tracks up to date.
Status SettleModel(const SparseOptions& options, const RunContext& context, SfmState& state);

/// As above for a model fused from parts: where they meet, observations may be off by more than the usual gate, which
/// is wide at first and then narrows.
Status CloseSeams(const SparseOptions& options, const RunContext& context, SfmState& state);

/// The adjustments and clean-up after the last view: noise is estimated and weights follow from it, wrong observations
/// and views with too little left go, tracks are completed. Of the input the features, what is known of them and
/// whether intrinsics are refined are read. Returns the noise that the weights rest on.
Result<NoiseLevels> FinishModel(const SparseInput& input, const SparseOptions& options, const RunContext& context,
                                SfmState& state);

}  // namespace drupe
