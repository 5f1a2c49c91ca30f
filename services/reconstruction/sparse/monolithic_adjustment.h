#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/bundle_adjustment.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// Bundle adjustment as one problem (Ceres, Schur complement, analytic derivatives), with or without the intrinsics.
/// Solved on one thread: Ceres adds up in the order in which its threads finish, and the result must not depend on the
/// thread count. Errors: `cancelled`, 500 `adjustment_failed`.
Status AdjustMonolithic(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options,
                        const RunContext& context);

}  // namespace drupe
