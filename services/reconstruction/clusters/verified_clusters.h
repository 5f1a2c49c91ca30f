#pragma once

#include "base/status.h"
#include "reconstruction/clusters/clusters.h"
#include "scene/view_graph.h"

namespace drupe {

/// Clusters for reconstruction, cut anew from what matching has verified: the same normalised cut and overlap as
/// RunClusters with the number of verified matches as the weight. Where a pattern looks alike from several sides, the
/// clusters of the likeness are torn over the ring; these hold pictures that see the same places. A cluster whose
/// pictures are not joined by verified pairs falls apart into those that are; pictures without any pair are in none.
/// `pairs` are the verified ones. Errors: 400 `invalid_option`, 400 `invalid_pair`.
Result<ViewClusters> ClusterVerified(int image_count, const MatchGraph& graph, const ViewClusterOptions& options);

}  // namespace drupe
