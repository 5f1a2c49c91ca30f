#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace drupe::dense {

/// The cubes of space that hold a cloud's points: a place for what varies slowly over a surface.
class SurfaceGrid {
 public:
  static constexpr int kNone = -1;

  /// The cells about a position with their trilinear weights. Cells that hold no point are kNone, of weight 0; the
  /// weights of the others need not add up to 1.
  struct Place {
    std::array<int, 8> cells;
    std::array<float, 8> weights;
  };

  /// `edge` > 0 in the cloud's units. Where the cloud's box has more than 2^24 such cubes, they are made larger.
  SurfaceGrid(const std::vector<Eigen::Vector3f>& positions, float edge);

  int cell_count() const { return static_cast<int>(cells_.size()); }
  /// The cell that holds a position, or kNone.
  int CellOf(const Eigen::Vector3f& position) const;
  Place At(const Eigen::Vector3f& position) const;
  /// The cells that touch a cell, at most 26, in ascending order of their coordinates.
  std::vector<int> Around(int cell) const;

 private:
  int IndexOf(const Eigen::Array3i& coordinates) const;

  Eigen::Array3f origin_ = Eigen::Array3f::Zero();
  float per_edge_ = 1;
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<std::int32_t> index_;    ///< of every cube of the box: its cell or kNone
  std::vector<Eigen::Array3i> cells_;  ///< coordinates, in the order of their first points
};

}  // namespace drupe::dense
