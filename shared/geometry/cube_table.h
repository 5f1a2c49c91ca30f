#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/cube_map.h"

namespace drupe {

/// A function of direction, tabulated at the corners of a CubeMap's cells and bilinear between them: (n + 1) x (n + 1)
/// values a face, row by row, in the order of CubeMap's faces. Continuous over the faces' edges when the values are.
template <typename Value>
class CubeTable {
 public:
  CubeTable() : map_(1) {}
  CubeTable(int n, std::vector<Value> corners) : map_(n), corners_(std::move(corners)) {}

  /// Tabulates `function(unit direction)`.
  template <typename Function>
  static CubeTable Of(int n, const Function& function) {
    std::vector<Value> corners;
    corners.reserve(static_cast<std::size_t>(6) * (n + 1) * (n + 1));
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row <= n; ++row) {
        for (int column = 0; column <= n; ++column) {
          corners.push_back(function(CubeMap::DirectionOf(face, column, row, n)));
        }
      }
    }
    return CubeTable(n, std::move(corners));
  }

  const CubeMap& map() const { return map_; }
  const Value& Corner(int face, int column, int row) const {
    return corners_[(static_cast<std::size_t>(face) * (map_.n() + 1) + row) * (map_.n() + 1) + column];
  }

  /// The value in a direction, which need not have unit length.
  Value At(const Eigen::Vector3f& direction) const {
    const CubeMap::Place place = map_.PlaceOf(direction);
    const int column = std::min(static_cast<int>(place.column), map_.n() - 1);
    const int row = std::min(static_cast<int>(place.row), map_.n() - 1);
    const float x = place.column - static_cast<float>(column);
    const float y = place.row - static_cast<float>(row);
    const Value* corner = &Corner(place.face, column, row);
    const Value upper = corner[0] + x * (corner[1] - corner[0]);
    const Value lower = corner[map_.n() + 1] + x * (corner[map_.n() + 2] - corner[map_.n() + 1]);
    return upper + y * (lower - upper);
  }

 private:
  CubeMap map_;
  std::vector<Value> corners_;
};

}  // namespace drupe
