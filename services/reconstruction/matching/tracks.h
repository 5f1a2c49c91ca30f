#pragma once

#include <span>

#include "base/run_context.h"
#include "base/status.h"
#include "scene/features.h"
#include "scene/view_graph.h"

namespace drupe {

struct TrackOptions {
  int min_length = 2;  ///< >= 2; shorter tracks are dropped

  /// 400 `invalid_option` naming the field that is out of its range.
  Status Check() const;
};

/// Joins pairwise matches into tracks by union-find. The pairs with most matches speak first; a match that would put
/// two places of one picture into a track is a conflict and is refused, so every track has at most one feature a view.
/// Features at the same place (several orientations of one extremum) count as one. Errors: 400 `invalid_option`, 400
/// `invalid_match` for a view or keypoint out of range.
Result<TrackList> RunTracks(const MatchGraph& graph, std::span<const Features> features, const TrackOptions& options,
                            const RunContext& context);

}  // namespace drupe
