#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace drupe {

/// Cells on the sphere of directions: the six faces of a cube, each divided into n x n cells of equal angle (Ronchi et
/// al., "The cubed sphere", 1996), so that cells differ by less than 1.42 in solid angle and there is no pole. Cell
/// numbers run face by face, row by row: (face * n + row) * n + column. Faces: +x -x +y -y +z -z.
class CubeMap {
 public:
  explicit CubeMap(int n) : n_(n), cells_per_radian_(static_cast<float>(n / kFaceAngle)) {}

  int n() const { return n_; }
  int size() const { return 6 * n_ * n_; }
  /// Angle between neighbouring cells at the middle of a face, in radians; smaller by at most 1.42 elsewhere.
  double CellAngle() const { return kFaceAngle / n_; }

  /// A place on the map: continuous coordinates from 0 to n within a face.
  struct Place {
    int face = 0;
    float column = 0;
    float row = 0;
  };

  /// `direction` need not have unit length; the zero vector belongs to some cell.
  Place PlaceOf(const Eigen::Vector3f& direction) const;
  int CellOf(const Eigen::Vector3f& direction) const { return CellOf(PlaceOf(direction)); }
  int CellOf(const Place& place) const {
    const int column = std::min(static_cast<int>(place.column), n_ - 1);
    const int row = std::min(static_cast<int>(place.row), n_ - 1);
    return (place.face * n_ + row) * n_ + column;
  }

  /// Unit direction of a place; coordinates may lie outside 0..n, which reaches over the face's edge.
  static Eigen::Vector3d DirectionOf(int face, double column, double row, int n);
  /// Unit direction of a cell's middle.
  Eigen::Vector3d DirectionOf(int cell) const;
  /// Solid angle of a cell; all cells together have 4 pi.
  double SolidAngle(int cell) const;
  /// The cell `columns` to the right and `rows` down, over the edge of the face if need be.
  int Neighbour(int cell, int columns, int rows) const;

 private:
  static constexpr double kFaceAngle = 1.5707963267948966;

  int n_;
  float cells_per_radian_;
};

}  // namespace drupe
