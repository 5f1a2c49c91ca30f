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

/// A view's strip of surface reaches so far, in OwnerLead's radians, into the strips beside it: about as far as two
/// views' normals of one place differ. What overlaps is removed afterwards.
constexpr double kSeamOverlap = 0.02;

/// Collects the patches of `fine_map(view)`, which is called once a view and from several threads, so that few of the
/// large finest maps are in memory at once; in order of view, row and column. A surface element is taken from the view
/// that sees it best only; strips overlap a little, and MarkDistinct removes what is double. `coarse_maps` at the level
/// of `coarse` say which views see it. Errors: `cancelled`, and the first of fine_map's.
Result<AssembledCloud> AssembleCloud(const LevelContext& fine,
                                     const std::function<Result<PatchMap>(int view)>& fine_map,
                                     const LevelContext& coarse, const std::vector<PatchMap>& coarse_maps,
                                     const RunContext& run);

}  // namespace drupe::dense
