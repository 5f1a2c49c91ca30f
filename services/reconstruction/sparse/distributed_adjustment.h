#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/bundle_adjustment.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// Bundle adjustment distributed over the shares of the tracks (one a cluster, SfmTrack::share), which work in
/// parallel. In each iteration a share eliminates its tracks and the views that only it touches and hands over
/// equations in the shared views alone; their sum is solved, and each share finds its own part from the solution.
/// Unlike consensus by averaging (Zhang et al. 2017) the shares agree exactly in every iteration, so the result is that
/// of the undivided problem. Levenberg-Marquardt with Cauchy losses, as AdjustBundle, whose parameters and gauge it
/// has; intrinsics stay as they are. The sums are formed in the order of the shares: the result does not depend on the
/// thread count. Errors: `cancelled`, 500 `adjustment_failed`.
Status AdjustDistributed(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options,
                         const RunContext& context);

}  // namespace drupe
