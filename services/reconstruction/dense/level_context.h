#pragma once

#include <cstdint>
#include <vector>

#include "reconstruction/dense/dense.h"
#include "reconstruction/dense/patch_map.h"
#include "reconstruction/dense/patch_refiner.h"
#include "reconstruction/dense/region_of_interest.h"
#include "reconstruction/dense/silhouette.h"
#include "reconstruction/dense/view_pyramid.h"

namespace drupe::dense {

/// What stays the same over all levels.
struct DenseScene {
  const DenseOptions* options = nullptr;
  const SparseModel* model = nullptr;
  RegionOfInterest region;
  std::vector<DenseView> views;              ///< the registered views that see the region
  std::vector<std::vector<int>> neighbours;  ///< per view, indices in `views`
  std::vector<Silhouette> silhouettes;       ///< per view
  double typical_depth = 1;
};

/// One level of the pyramid, for all reference views.
struct LevelContext {
  const DenseScene* scene = nullptr;
  int level = 0;
  int csize = 1;
  std::vector<LevelCamera> cameras;  ///< per view
  std::vector<RefinerFrame> frames;  ///< per view
  RefinerSettings settings;

  PatchMap EmptyMap(int view) const;
};

LevelContext MakeLevelContext(const DenseScene& scene, int level, int csize);

/// The neighbours of `reference` that may see the element: turned towards them by less than 75 degrees. Bit k for the
/// k-th neighbour; 0 also when the reference itself sees it at more than 80 degrees.
std::uint32_t FacingNeighbours(const DenseScene& scene, int reference, const SurfaceElement& element);

/// True where the reference shows background, or is too dark to show a surface. (u, v) in pixels of the level.
bool IsBackground(const LevelContext& context, int reference, int u, int v);

/// True when a refined patch is photo-consistent: enough views under a sufficient angle, mean NCC, position and normal.
bool IsAcceptable(const LevelContext& context, int reference, double u, double v, const PatchCell& cell);

}  // namespace drupe::dense
