#include "defect_analysis/defects/skin_map.h"

#include <algorithm>
#include <cmath>

namespace drupe {
namespace {

constexpr double kPointsPerCell = 2;
constexpr int kMinCells = 12;  // a side of a face
constexpr int kMaxCells = 512;

int CellsFor(const FruitCloud& fruit) {
  const double seen = std::max(0.1, fruit.observed_share);
  const double cells = static_cast<double>(fruit.size()) / (kPointsPerCell * seen);
  return std::clamp(static_cast<int>(std::sqrt(cells / 6)), kMinCells, kMaxCells);
}

}  // namespace

SkinMap::SkinMap(const FruitCloud& fruit) : map_(CellsFor(fruit)) {
  SortPoints(fruit);
  MeasureCells(fruit.surface);
}

void SkinMap::SortPoints(const FruitCloud& fruit) {
  std::vector<std::int32_t> cell_of(fruit.size());
  first_.assign(map_.size() + 1, 0);
  for (std::size_t i = 0; i < fruit.size(); ++i) {
    cell_of[i] = map_.CellOf(fruit.offsets[i]);
    ++first_[cell_of[i] + 1];
  }
  for (int cell = 0; cell < map_.size(); ++cell) first_[cell + 1] += first_[cell];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  order_.resize(fruit.size());
  for (std::size_t i = 0; i < fruit.size(); ++i) order_[next[cell_of[i]]++] = static_cast<std::uint32_t>(i);
}

void SkinMap::MeasureCells(const FruitSurface& surface) {
  area_.resize(map_.size());
  neighbours_.resize(8 * static_cast<std::size_t>(map_.size()));
  double sum = 0;
  for (int cell = 0; cell < map_.size(); ++cell) {
    const float radius = surface.RadiusAt(map_.DirectionOf(cell).cast<float>());
    area_[cell] = static_cast<float>(map_.SolidAngle(cell)) * radius * radius;
    sum += area_[cell];
    std::int32_t* neighbours = &neighbours_[8 * static_cast<std::size_t>(cell)];
    for (const auto& [columns, rows] :
         {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}) {
      *neighbours++ = map_.Neighbour(cell, columns, rows);
    }
  }
  cell_size_ = std::sqrt(sum / map_.size());
}

}  // namespace drupe
