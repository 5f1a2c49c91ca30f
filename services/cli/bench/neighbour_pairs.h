#pragma once

#include <vector>

#include "scene/view_graph.h"

namespace drupe {

/// Every picture of a turn with the `window` that follow it, the last ones with the first; ascending.
std::vector<ImagePair> NeighbourPairs(int count, int window);

}  // namespace drupe
