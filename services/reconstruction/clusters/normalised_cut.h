#pragma once

#include <utility>
#include <vector>

#include "scene/view_graph.h"

namespace drupe {

/// Divides a group of two or more images in two by the normalised cut (Shi & Malik 2000): the second eigenvector of the
/// graph's normalised Laplacian orders them, and of the places to cut that leave each side a third of the images at
/// least, the one with the lowest cut is taken. Both sides ascending.
std::pair<std::vector<int>, std::vector<int>> NormalisedCut(const SimilarityGraph& graph,
                                                            const std::vector<int>& images);

/// Cuts `images` (ascending) until no group has more than `max_size` >= 1, in the order of their first images.
std::vector<std::vector<int>> DivideByCut(const SimilarityGraph& graph, const std::vector<int>& images, int max_size);

}  // namespace drupe
