#pragma once

#include <functional>
#include <vector>

#include "reconstruction/dense/level_context.h"
#include "reconstruction/dense/visibility.h"

namespace drupe::dense {

/// The points of the finest level and the view each comes from.
struct AssembledCloud {
  PointCloud cloud;  ///< without colours
  std::vector<int> owners;
};

/// Collects the patches of `fine_map(view)`, which is called once a view and from several threads, so that few of the
/// large finest maps are in memory at once; in order of view, row and column. A surface element is taken from the view
/// that sees it best only, so that nothing is repeated (the consistency comparison of paper 3.1.3); `coarse_maps` at
/// the level of `coarse` say which views see it.
Result<AssembledCloud> AssembleCloud(const LevelContext& fine, const std::function<PatchMap(int view)>& fine_map,
                                     const LevelContext& coarse, const std::vector<PatchMap>& coarse_maps,
                                     const RunContext& run);

}  // namespace drupe::dense
