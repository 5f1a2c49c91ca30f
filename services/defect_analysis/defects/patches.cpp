#include "defect_analysis/defects/patches.h"

#include <algorithm>
#include <numeric>

namespace drupe {
namespace {

// Cells reachable in at most `steps` steps between neighbours from a significant cell, itself included.
void VisitAround(const SkinMap& map, std::int32_t cell, int steps, std::vector<std::int32_t>& around) {
  around.assign(1, cell);
  std::size_t begin = 0;
  for (int step = 0; step < steps; ++step) {
    const std::size_t end = around.size();
    for (; begin < end; ++begin) {
      for (const std::int32_t other : map.NeighboursOf(around[begin])) {
        if (std::find(around.begin(), around.end(), other) == around.end()) around.push_back(other);
      }
    }
  }
}

Patch Grow(const SkinMap& map, const Segmentation& segmentation, std::int32_t seed, int steps, std::int32_t number,
           std::vector<std::int32_t>& patch_of) {
  Patch patch;
  std::vector<std::int32_t> around;
  patch_of[seed] = number;
  patch.cells.push_back(seed);
  for (std::size_t next = 0; next < patch.cells.size(); ++next) {
    VisitAround(map, patch.cells[next], steps, around);
    for (const std::int32_t other : around) {
      if (segmentation.class_of[other] == 0 || patch_of[other] != -1) continue;
      patch_of[other] = number;
      patch.cells.push_back(other);
    }
  }
  for (const std::int32_t cell : patch.cells) patch.area_mm2 += map.AreaOf(cell);
  std::sort(patch.cells.begin(), patch.cells.end());
  return patch;
}

}  // namespace

std::vector<Patch> FindPatches(const SkinMap& map, const Segmentation& segmentation, const ClusterOptions& options,
                               std::vector<std::int32_t>* patch_of) {
  constexpr int kMaxSteps = 4;
  const int steps = std::clamp(static_cast<int>(options.merge_distance_mm / map.CellSize()), 1, kMaxSteps);
  std::vector<std::int32_t> number(map.size(), -1);
  std::vector<Patch> patches;
  for (std::int32_t cell = 0; cell < map.size(); ++cell) {
    if (segmentation.class_of[cell] == 0 || number[cell] != -1) continue;
    patches.push_back(Grow(map, segmentation, cell, steps, 0, number));
  }
  std::erase_if(patches, [&](const Patch& patch) { return patch.area_mm2 < options.min_area_mm2; });
  std::stable_sort(patches.begin(), patches.end(),
                   [](const Patch& a, const Patch& b) { return a.area_mm2 > b.area_mm2; });
  if (static_cast<int>(patches.size()) > options.max_defects) patches.resize(options.max_defects);
  if (patch_of == nullptr) return patches;
  for (std::int32_t& n : number) n = n == -1 ? -1 : -2;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    for (const std::int32_t cell : patches[k].cells) number[cell] = static_cast<std::int32_t>(k);
  }
  *patch_of = std::move(number);
  return patches;
}

}  // namespace drupe
