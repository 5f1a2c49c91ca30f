#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/features.h"

namespace drupe {

/// Points of a picture by square cells, for questions about a neighbourhood.
class KeypointGrid {
 public:
  KeypointGrid() = default;
  /// `cell` is the side of a cell, in the unit of the points; non-finite points must not occur.
  KeypointGrid(std::span<const Eigen::Vector2f> points, float cell);
  /// The places of a picture's keypoints, in their order.
  KeypointGrid(const Features& picture, float cell);

  /// Calls visit(index) for every point in the cells that the box touches: all points of the box, and some around it.
  template <typename Visit>
  void VisitBox(const Eigen::Vector2f& low, const Eigen::Vector2f& high, const Visit& visit) const {
    const int left = ColumnOf(low.x()), right = ColumnOf(high.x());
    for (int row = RowOf(low.y()), last = RowOf(high.y()); row <= last; ++row) {
      const std::size_t base = static_cast<std::size_t>(row) * columns_;
      for (std::uint32_t i = starts_[base + left]; i < starts_[base + right + 1]; ++i) visit(order_[i]);
    }
  }

 private:
  int ColumnOf(float x) const;
  int RowOf(float y) const;

  float cell_ = 1;
  Eigen::Vector2f origin_ = Eigen::Vector2f::Zero();
  int columns_ = 1, rows_ = 1;
  std::vector<std::uint32_t> starts_ = {0, 0};  ///< per cell, row by row, where its points begin in order_
  std::vector<std::uint32_t> order_;
};

}  // namespace drupe
