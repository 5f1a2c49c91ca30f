#pragma once

#include <vector>

#include "reconstruction/dense/region_of_interest.h"
#include "reconstruction/dense/view_pyramid.h"
#include "scene/sparse_model.h"

namespace drupe::dense {

/// Most neighbours that a patch is compared with.
constexpr int kMaxNeighbours = 8;

/// For every view the views (indices in `views`) that see the same surface under angles good for stereo, best first, at
/// most kMaxNeighbours. Judged by the tracks in the region: those likely to be visible, weighted by the angle between
/// the two rays (small angles measure depth badly, large ones distort the patch).
std::vector<std::vector<int>> SelectNeighbours(const SparseModel& model, const RegionOfInterest& region,
                                               const std::vector<DenseView>& views);

}  // namespace drupe::dense
