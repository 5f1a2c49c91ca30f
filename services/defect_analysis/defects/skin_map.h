#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/cube_map.h"
#include "scene/fruit_cloud.h"

namespace drupe {

/// A fruit's points sorted into cells of directions about its centre, so that neighbours on the skin are found without
/// a search tree: about two points a cell, whatever the cloud's density.
class SkinMap {
 public:
  explicit SkinMap(const FruitCloud& fruit);

  const CubeMap& map() const { return map_; }
  int size() const { return map_.size(); }
  /// Indices of a cell's points in the fruit's cloud, ascending.
  std::span<const std::uint32_t> PointsOf(int cell) const {
    return {order_.data() + first_[cell], order_.data() + first_[cell + 1]};
  }
  int CountOf(int cell) const { return static_cast<int>(first_[cell + 1] - first_[cell]); }
  /// Area of the skin in a cell, mm2.
  float AreaOf(int cell) const;
  /// Distance between the middles of neighbouring cells, mm, on average.
  double CellSize() const { return cell_size_; }
  /// The four cells that share an edge with a cell, and the four that share a corner only.
  std::array<std::int32_t, 8> NeighboursOf(int cell) const {
    const int n = map_.n(), column = cell % n, row = cell / n % n;
    if (column == 0 || column == n - 1 || row == 0 || row == n - 1) return NeighboursAtEdge(cell);
    return {cell + 1, cell - 1, cell + n, cell - n, cell + n + 1, cell + n - 1, cell - n + 1, cell - n - 1};
  }

 private:
  void SortPoints(const FruitCloud& fruit);
  std::array<std::int32_t, 8> NeighboursAtEdge(int cell) const;

  FruitSurface surface_;
  CubeMap map_;
  std::vector<std::uint32_t> first_;  ///< where each cell's points begin in order_; size() + 1 values
  std::vector<std::uint32_t> order_;
  double cell_size_ = 0;
};

/// Steps between neighbouring cells from the nearest cell with a 1 in `from`; `most` + 1 beyond `most`.
std::vector<int> StepsFrom(const SkinMap& map, const std::vector<std::uint8_t>& from, int most);

}  // namespace drupe
