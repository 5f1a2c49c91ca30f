#include "defect_analysis/defects/find_defects.h"

#include <algorithm>

#include "base/parallel.h"
#include "defect_analysis/defects/healthy_skin.h"
#include "defect_analysis/defects/measure_defect.h"
#include "defect_analysis/defects/patches.h"
#include "defect_analysis/defects/segmentation.h"
#include "defect_analysis/defects/skin_map.h"

namespace drupe {
namespace {

std::vector<Defect> MeasurePatch(const FruitCloud& fruit, const SkinMap& map, const Patch& patch, int number,
                                 const std::vector<std::int32_t>& patch_of, const DefectOptions& options,
                                 std::uint64_t seed) {
  std::vector<Defect> defects;
  const auto field = BuildTransitionField(fruit, map, patch, number, patch_of);
  if (!field) return defects;
  for (const Polygon& boundary : TraceBoundaries(*field, options.contour.level, options.cluster.min_area_mm2)) {
    auto defect = MeasureDefect(fruit, map, *field, boundary, options, seed + static_cast<std::uint64_t>(number));
    if (defect) defects.push_back(std::move(*defect));
  }
  return defects;
}

}  // namespace

Result<std::vector<Defect>> FindDefects(const FruitCloud& fruit, const DefectOptions& options,
                                        const RunContext& context) {
  const SkinMap map(fruit);
  DRUPE_ASSIGN_OR_RETURN(const SkinColours colours, MeasureDeviation(fruit, map, options.segmentation));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  const Segmentation segmentation =
      SegmentColours(colours.deviation, colours.seen, colours.sigma, options.segmentation);
  std::vector<std::int32_t> patch_of;
  const std::vector<Patch> patches = FindPatches(map, segmentation, options.cluster, &patch_of);
  std::vector<std::vector<Defect>> measured(patches.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, patches.size(), [&](std::size_t k) {
    measured[k] = MeasurePatch(fruit, map, patches[k], static_cast<int>(k), patch_of, options, context.seed);
  }));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  std::vector<Defect> defects;
  for (auto& list : measured) defects.insert(defects.end(), list.begin(), list.end());
  std::stable_sort(defects.begin(), defects.end(),
                   [](const Defect& a, const Defect& b) { return a.area_mm2 > b.area_mm2; });
  for (std::size_t k = 0; k < defects.size(); ++k) defects[k].id = static_cast<int>(k) + 1;
  return defects;
}

}  // namespace drupe
