#pragma once

#include <cstdint>
#include <vector>

#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/healthy_skin.h"
#include "defect_analysis/defects/segmentation.h"
#include "defect_analysis/defects/skin_map.h"

namespace drupe {

/// A connected patch of significant cells: a defect, or several that touch.
struct Patch {
  std::vector<std::int32_t> cells;  ///< ascending
  double area_mm2 = 0;              ///< of the cells
};

/// Groups significant cells into patches: Euclidean clusters on the skin (paper Figure 12), found cell by cell in
/// linear time. Cells that touch, or that are no more than merge_distance_mm apart, belong together; patches smaller
/// than min_area_mm2 are dropped. Largest first. `patch_of`, when given, receives for every cell the number of its
/// patch, -1 for none (dropped patches included: those cells are not healthy either and get -2).
std::vector<Patch> FindPatches(const SkinMap& map, const Segmentation& segmentation, const ClusterOptions& options,
                               std::vector<std::int32_t>* patch_of);

}  // namespace drupe
