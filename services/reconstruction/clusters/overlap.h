#pragma once

#include <vector>

#include "scene/view_graph.h"

namespace drupe {

/// The overlap rate of a cluster: the images it shares with each other cluster, summed, per image of it (the
/// completeness of Chen et al. 2020, "Graph-based parallel large scale structure from motion").
double OverlapOf(const std::vector<std::vector<int>>& clusters, std::size_t cluster);

/// Lets every cluster and the two to which its strongest edges lead take in the ends of these edges, as far as
/// `max_size` allows, so that neighbours have images in common on every side: growth by
/// likeness alone may link a cluster to one side only. They stay ascending.
void LinkNeighbours(const SimilarityGraph& graph, int max_size, std::vector<std::vector<int>>& clusters);

/// Lets clusters that overlap too little take in the images most similar to theirs, or, once they have `max_size`
/// images, lend theirs to others, one at a time in turn, until all reach `min_overlap` or none has room. They stay
/// ascending.
void GrowOverlap(const SimilarityGraph& graph, double min_overlap, int max_size,
                 std::vector<std::vector<int>>& clusters);

}  // namespace drupe
