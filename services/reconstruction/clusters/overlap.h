#pragma once

#include <vector>

#include "scene/view_graph.h"

namespace drupe {

/// The overlap rate of a cluster: the images it shares with each other cluster, summed, per image of it (the
/// completeness of Chen et al. 2020, "Graph-based parallel large scale structure from motion").
double OverlapOf(const std::vector<std::vector<int>>& clusters, std::size_t cluster);

/// Lets clusters take in the images most similar to theirs, one at a time in turn, until each has `min_overlap` or
/// max_size images. The clusters stay ascending.
void GrowOverlap(const SimilarityGraph& graph, double min_overlap, int max_size,
                 std::vector<std::vector<int>>& clusters);

}  // namespace drupe
