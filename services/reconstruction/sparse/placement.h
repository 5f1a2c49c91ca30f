#pragma once

#include <optional>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// Places as many of the `view_count` views that the state is about as possible: by the board first where most of them
/// see it, otherwise from an initial pair by features; the board then gives frame and scale if it is seen often enough.
/// `board_poses`: per view, from the board alone. Errors: 422 `no_initial_pair`, `cancelled`, 500 `adjustment_failed`.
Status PlaceViews(const MatchGraph& matches, const std::vector<std::optional<Rigid3>>& board_poses, int view_count,
                  const SparseOptions& options, const RunContext& context, SfmState& state);

}  // namespace drupe
