#include "defect_analysis/defects/find_defects.h"

#include <algorithm>

#include "base/parallel.h"
#include "defect_analysis/defects/bridge_gaps.h"
#include "defect_analysis/defects/healthy_skin.h"
#include "defect_analysis/defects/measure_defect.h"
#include "defect_analysis/defects/patches.h"
#include "defect_analysis/defects/segmentation.h"
#include "defect_analysis/defects/separate.h"
#include "defect_analysis/defects/significance.h"
#include "defect_analysis/defects/skin_map.h"

namespace drupe {
namespace {

constexpr double kMeasuredShare = 0.6;  // of a defect's area: less is guessed from stray points in a gap

// One fruit's skin, ready to be measured.
struct Skin {
  const FruitCloud& measured;
  const FruitCloud& bridged;  // `measured` and points in its gaps, sorted into the map
  const SkinMap& map;
  double threshold = 0;  // Segmentation::threshold
  std::vector<std::int32_t> patch_of{};
};

// Share of a patch's area that was measured and not bridged.
double MeasuredShare(const Skin& skin, const Patch& patch) {
  double measured = 0;
  for (const std::int32_t cell : patch.cells) {
    const auto points = skin.map.PointsOf(cell);  // ascending, measured ones first
    if (!points.empty() && points.front() < skin.measured.size()) measured += skin.map.AreaOf(cell);
  }
  return measured / patch.area_mm2;
}

std::vector<Defect> MeasurePatch(const Skin& skin, const Patch& patch, int number, const DefectOptions& options,
                                 std::uint64_t seed) {
  std::vector<Defect> defects;
  if (MeasuredShare(skin, patch) < kMeasuredShare) return defects;
  auto field = BuildTransitionField(skin.bridged, skin.map, patch, number, skin.patch_of);
  if (!field || !StandsOut(*field, skin.threshold, options.segmentation)) return defects;
  const Outlines found = SeparateDefects(std::move(*field), skin.threshold, options);
  for (const Outline& outline : found.outlines) {
    auto defect = MeasureDefect(skin.measured, skin.map, outline, options, seed + static_cast<std::uint64_t>(number));
    if (defect) defects.push_back(std::move(*defect));
  }
  return defects;
}

}  // namespace

Result<std::vector<Defect>> FindDefects(const FruitCloud& fruit, const DefectOptions& options,
                                        const RunContext& context) {
  const FruitCloud bridged = BridgeGaps(fruit, SkinMap(fruit), options.cluster.bridge_mm);
  const SkinMap map(bridged);
  DRUPE_ASSIGN_OR_RETURN(const SkinColours colours, MeasureDeviation(bridged, map, options.segmentation));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  const Segmentation segmentation =
      SegmentColours(colours.deviation, colours.seen, colours.sigma, options.segmentation);
  Skin skin{.measured = fruit, .bridged = bridged, .map = map, .threshold = segmentation.threshold};
  const std::vector<Patch> patches = FindPatches(map, segmentation, options.cluster, &skin.patch_of);
  std::vector<std::vector<Defect>> measured(patches.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, patches.size(), [&](std::size_t k) {
    measured[k] = MeasurePatch(skin, patches[k], static_cast<int>(k), options, context.seed);
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
