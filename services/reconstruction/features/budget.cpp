#include "reconstruction/features/budget.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace drupe {
namespace {

/// An extremum in pixels of the full picture.
struct Placed {
  Extremum extremum;
  float x, y, sigma;
};

bool CoarserFirst(const Placed& a, const Placed& b) {
  return std::tie(b.sigma, a.y, a.x) < std::tie(a.sigma, b.y, b.x);
}

bool SamePlace(const Placed& a, const Placed& b) {
  return a.sigma == b.sigma && a.y == b.y && a.x == b.x;
}

std::vector<Placed> Place(const std::vector<Extremum>& extrema, std::span<const Octave> octaves) {
  std::vector<Placed> placed;
  placed.reserve(extrema.size());
  for (const Extremum& e : extrema) {
    const float step = octaves[e.octave].pixel_step;
    placed.push_back({e, e.x * step, e.y * step, e.sigma * step});
  }
  std::sort(placed.begin(), placed.end(), CoarserFirst);
  placed.erase(std::unique(placed.begin(), placed.end(), SamePlace), placed.end());
  return placed;
}

/// rank[i]: how many extrema of i's cell are stronger than it.
std::vector<int> RanksInCells(const std::vector<Placed>& placed, int cell_px, int columns, int rows) {
  std::vector<std::vector<int>> cells(static_cast<std::size_t>(columns) * rows);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const int column = std::clamp(static_cast<int>(placed[i].x) / cell_px, 0, columns - 1);
    const int row = std::clamp(static_cast<int>(placed[i].y) / cell_px, 0, rows - 1);
    cells[static_cast<std::size_t>(row) * columns + column].push_back(static_cast<int>(i));
  }
  std::vector<int> rank(placed.size());
  for (std::vector<int>& cell : cells) {
    std::stable_sort(cell.begin(), cell.end(),
                     [&placed](int a, int b) { return placed[a].extremum.response > placed[b].extremum.response; });
    for (std::size_t r = 0; r < cell.size(); ++r) rank[cell[r]] = static_cast<int>(r);
  }
  return rank;
}

/// The largest number of extrema per cell at which no more than `max_count` are kept.
int Quota(const std::vector<int>& rank, int max_count) {
  std::vector<int> at_rank;
  for (const int r : rank) {
    if (r >= static_cast<int>(at_rank.size())) at_rank.resize(r + 1, 0);
    ++at_rank[r];
  }
  int kept = 0, quota = 0;
  while (quota < static_cast<int>(at_rank.size()) && kept + at_rank[quota] <= max_count) kept += at_rank[quota++];
  return quota;
}

}  // namespace

std::vector<Extremum> SelectSpread(std::vector<Extremum> extrema, std::span<const Octave> octaves, int cell_px,
                                   int max_count) {
  const std::vector<Placed> placed = Place(extrema, octaves);
  const auto cells_along = [cell_px, &octaves](int octave_pixels) {
    return std::max(1, static_cast<int>(octave_pixels * octaves[0].pixel_step) / cell_px + 1);
  };
  const std::vector<int> rank =
      RanksInCells(placed, cell_px, cells_along(octaves[0].width()), cells_along(octaves[0].height()));
  const int quota = std::max(1, Quota(rank, max_count));
  std::vector<Extremum> selected;
  for (std::size_t i = 0; i < placed.size() && static_cast<int>(selected.size()) < max_count; ++i) {
    if (rank[i] < quota) selected.push_back(placed[i].extremum);
  }
  return selected;
}

}  // namespace drupe
