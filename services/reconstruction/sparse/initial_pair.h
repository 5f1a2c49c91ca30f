#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// Begins a model without a board: chooses two views by the number of matches, the angle under which they see the scene
/// and how far the scene is from a plane (a plane leaves the relative pose ambiguous), places them, triangulates and
/// adjusts. Error: 422 `no_initial_pair` with what to change on the rig; `cancelled`.
Status StartFromPair(const MatchGraph& matches, const SparseOptions& options, const RunContext& context,
                     SfmState& state);

}  // namespace drupe
