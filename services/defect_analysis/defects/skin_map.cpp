#include "defect_analysis/defects/skin_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

// Mean over all directions of the squared distance to the skin.
double MeanSquaredRadius(const FruitSurface& surface) {
  constexpr int kCells = 24;
  const CubeMap map(kCells);
  double sum = 0;
  for (int cell = 0; cell < map.size(); ++cell) {
    const double radius = surface.RadiusAt(map.DirectionOf(cell).cast<float>());
    sum += map.SolidAngle(cell) * radius * radius;
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace

SkinMap::SkinMap(const FruitCloud& fruit) : surface_(fruit.surface), map_(CellsFor(fruit)) {
  SortPoints(fruit);
  cell_size_ = std::sqrt(4 * std::numbers::pi * MeanSquaredRadius(surface_) / map_.size());
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

float SkinMap::AreaOf(int cell) const {
  const float radius = surface_.RadiusAt(map_.DirectionOf(cell).cast<float>());
  return static_cast<float>(map_.SolidAngle(cell)) * radius * radius;
}

std::array<std::int32_t, 8> SkinMap::NeighboursAtEdge(int cell) const {
  return {map_.Neighbour(cell, 1, 0),  map_.Neighbour(cell, -1, 0), map_.Neighbour(cell, 0, 1),
          map_.Neighbour(cell, 0, -1), map_.Neighbour(cell, 1, 1),  map_.Neighbour(cell, -1, 1),
          map_.Neighbour(cell, 1, -1), map_.Neighbour(cell, -1, -1)};
}

std::vector<int> StepsFrom(const SkinMap& map, const std::vector<std::uint8_t>& from, int most) {
  std::vector<int> steps(from.size(), most + 1);
  std::vector<std::int32_t> front;
  for (std::size_t cell = 0; cell < from.size(); ++cell) {
    if (from[cell] == 0) continue;
    steps[cell] = 0;
    front.push_back(static_cast<std::int32_t>(cell));
  }
  for (std::size_t next = 0; next < front.size() && steps[front[next]] < most; ++next) {
    for (const std::int32_t other : map.NeighboursOf(front[next])) {
      if (steps[other] <= most) continue;
      steps[other] = steps[front[next]] + 1;
      front.push_back(other);
    }
  }
  return steps;
}

}  // namespace drupe
