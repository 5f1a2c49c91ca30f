#include "defect_analysis/defects/find_defects.h"

#include <algorithm>
#include <cmath>
#include <utility>

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
constexpr double kHalo = 0.7;           // mm about a patch that its own soft edge and shade may colour

// One fruit's skin, ready to be measured.
struct Skin {
  const FruitCloud& measured;
  const FruitCloud& bridged;  // `measured` and points in its gaps, sorted into the map
  const SkinMap& map;
};

// Looks at the skin, for ever lower contrasts and with ever stricter questions.
enum class Look { kClear, kFaint, kFaintest };

// Patches of significant cells, to be looked at one by one.
struct Candidates {
  double threshold = 0;  // Segmentation::threshold
  Look look = Look::kClear;
  std::vector<Patch> patches{};
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

// Two defects that touch, where their joint patch does not stand out: its colour and edge are those of neither.
Outlines SeparateHidden(const TransitionField& field, const Candidates& candidates, const DefectOptions& options) {
  if (candidates.look != Look::kClear) return {};
  return SeparateLayers(field, candidates.threshold, options);
}

bool IsSignificant(const TransitionField& field, const Candidates& candidates, const DefectOptions& options) {
  switch (candidates.look) {
    case Look::kClear:
      return StandsOut(field, candidates.threshold, options);
    case Look::kFaint:
      return StandsOutFaintly(field, candidates.threshold, options);
    case Look::kFaintest:
      return StandsOutByItsRim(field, candidates.threshold, options);
  }
  return false;
}

std::vector<Defect> MeasurePatch(const Skin& skin, const Candidates& candidates, std::size_t number,
                                 const DefectOptions& options, std::uint64_t seed) {
  std::vector<Defect> defects;
  const Patch& patch = candidates.patches[number];
  if (MeasuredShare(skin, patch) < kMeasuredShare) return defects;
  auto field = BuildTransitionField(skin.bridged, skin.map, patch, static_cast<int>(number), candidates.patch_of);
  if (!field) return defects;
  const Outlines found = IsSignificant(*field, candidates, options)
                             ? SeparateDefects(std::move(*field), candidates.threshold, options)
                             : SeparateHidden(*field, candidates, options);
  for (const Outline& outline : found.outlines) {
    auto defect = MeasureDefect(skin.measured, skin.map, outline, options, seed + number);
    if (defect && IsEstablished(*defect)) defects.push_back(std::move(*defect));
  }
  return defects;
}

Candidates FindCandidates(const Skin& skin, const SkinColours& colours, const DefectOptions& options) {
  const Segmentation segmentation =
      SegmentColours(colours.deviation, colours.seen, colours.sigma, options.segmentation);
  Candidates candidates{.threshold = segmentation.threshold};
  candidates.patches = FindPatches(skin.map, segmentation, options.cluster, &candidates.patch_of);
  return candidates;
}

// Another look at colours of a lower contrast, clear of the cells that are `taken`.
Candidates FindFainter(const Skin& skin, const SkinColours& colours, const std::vector<std::uint8_t>& taken,
                       double share, Look look, const DefectOptions& options) {
  SegmentationOptions lower = options.segmentation;
  lower.significance_delta_e *= share;
  lower.significance_sigma *= share;
  Segmentation segmentation = SegmentColours(colours.deviation, colours.seen, colours.sigma, lower);
  const int halo = static_cast<int>(std::ceil(kHalo / skin.map.CellSize()));
  const std::vector<int> steps = StepsFrom(skin.map, taken, halo);
  for (std::size_t cell = 0; cell < taken.size(); ++cell) {
    if (steps[cell] <= halo) segmentation.class_of[cell] = 0;
  }
  Candidates candidates{.threshold = segmentation.threshold, .look = look};
  candidates.patches = FindPatches(skin.map, segmentation, options.cluster, &candidates.patch_of);
  for (std::size_t cell = 0; cell < taken.size(); ++cell) {
    if (steps[cell] <= halo) candidates.patch_of[cell] = -2;  // no healthy skin either
  }
  return candidates;
}

// Adds the defects among the candidates to `defects`, and takes the cells of their patches. A clear patch's cells are
// taken in any case: what it is has been settled.
Status MeasureAll(const Skin& skin, const Candidates& candidates, const DefectOptions& options,
                  const RunContext& context, std::vector<Defect>* defects, std::vector<std::uint8_t>* taken) {
  std::vector<std::vector<Defect>> measured(candidates.patches.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, measured.size(), [&](std::size_t k) {
    measured[k] = MeasurePatch(skin, candidates, k, options, context.seed);
  }));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  for (auto& list : measured) defects->insert(defects->end(), list.begin(), list.end());
  for (std::size_t cell = 0; cell < taken->size(); ++cell) {
    const std::int32_t patch = candidates.patch_of[cell];
    if (patch >= 0 && (candidates.look == Look::kClear || !measured[patch].empty())) (*taken)[cell] = 1;
  }
  return Status::Ok();
}

}  // namespace

Result<std::vector<Defect>> FindDefects(const FruitCloud& fruit, const DefectOptions& options,
                                        const RunContext& context) {
  const FruitCloud bridged = BridgeGaps(fruit, SkinMap(fruit), options.cluster.bridge_mm);
  const SkinMap map(bridged);
  DRUPE_ASSIGN_OR_RETURN(const SkinColours colours, MeasureDeviation(bridged, map, options.segmentation));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  const Skin skin{.measured = fruit, .bridged = bridged, .map = map};
  std::vector<Defect> defects;
  const Candidates clear = FindCandidates(skin, colours, options);
  std::vector<std::uint8_t> taken(clear.patch_of.size(), 0);
  DRUPE_RETURN_IF_ERROR(MeasureAll(skin, clear, options, context, &defects, &taken));
  const std::pair<double, Look> looks[] = {{options.segmentation.faint_share, Look::kFaint},
                                           {options.segmentation.faintest_share, Look::kFaintest}};
  for (const auto& [share, look] : looks) {
    if (share == 1) continue;
    const Candidates fainter = FindFainter(skin, colours, taken, share, look, options);
    DRUPE_RETURN_IF_ERROR(MeasureAll(skin, fainter, options, context, &defects, &taken));
  }
  std::stable_sort(defects.begin(), defects.end(),
                   [](const Defect& a, const Defect& b) { return a.area_mm2 > b.area_mm2; });
  for (std::size_t k = 0; k < defects.size(); ++k) defects[k].id = static_cast<int>(k) + 1;
  return defects;
}

}  // namespace drupe
