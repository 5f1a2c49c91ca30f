#pragma once

#include <optional>
#include <vector>

#include "base/run_context.h"
#include "base/stage_parts.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// The model of one cluster: a state over the views of the whole set (those outside the cluster have no pose) with the
/// parts of the tracks that the cluster sees.
struct ClusterModel {
  SfmState state;
  std::vector<int> whole_track;  ///< per track of `state`, its number in the whole state, ascending
};

/// The part of `whole` that a cluster (view indices, ascending) sees: tracks with two observations or more.
ClusterModel RestrictTo(const SfmState& whole, const std::vector<int>& cluster);

/// Incremental structure from motion of every cluster on its own (paper 3.1.2), clusters in parallel: placed as
/// PlaceViews does, then adjusted. With options.parts by run_parts, unless that is empty. A cluster in which nothing
/// can be placed has a model without poses. Errors: `cancelled`, 500 `adjustment_failed`.
Result<std::vector<ClusterModel>> BuildClusterModels(const SfmState& whole,
                                                     const std::vector<std::vector<int>>& clusters,
                                                     const MatchGraph& matches,
                                                     const std::vector<std::optional<Rigid3>>& board_poses,
                                                     const SparseOptions& options, const RunParts& run_parts,
                                                     const RunContext& context);

}  // namespace drupe
