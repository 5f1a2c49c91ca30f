#include "geometry/cube_map.h"

#include <algorithm>
#include <array>

namespace drupe {
namespace {

// atan(t) for |t| <= 1, within 2e-6: an odd minimax polynomial, since a call to std::atan2 for every point of a cloud
// costs more than all else that is done with its direction.
inline float FastAtan(float t) {
  const float s = t * t;
  return t * (0.99997726f +
              s * (-0.33262347f + s * (0.19354346f + s * (-0.11643287f + s * (0.05265332f + s * -0.01172120f)))));
}

// For each face: the axis it looks along, and the axes of its columns and rows.
constexpr std::array<std::array<int, 3>, 3> kAxes = {{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};

}  // namespace

CubeMap::Place CubeMap::PlaceOf(const Eigen::Vector3f& direction) const {
  const Eigen::Vector3f size = direction.cwiseAbs();
  const int major = size.x() >= size.y() ? (size.x() >= size.z() ? 0 : 2) : (size.y() >= size.z() ? 1 : 2);
  const auto& axes = kAxes[major];
  const float inverse = size[major] > 0 ? 1.0f / size[major] : 0.0f;
  const float limit = static_cast<float>(n_);
  const float half = 0.5f * limit;
  Place place;
  place.face = 2 * major + (direction[major] < 0 ? 1 : 0);
  place.column = std::clamp(FastAtan(direction[axes[1]] * inverse) * cells_per_radian_ + half, 0.0f, limit);
  place.row = std::clamp(FastAtan(direction[axes[2]] * inverse) * cells_per_radian_ + half, 0.0f, limit);
  return place;
}

Eigen::Vector3d CubeMap::DirectionOf(int face, double column, double row, int n) {
  const auto& axes = kAxes[face / 2];
  const double along = face % 2 == 0 ? 1.0 : -1.0;
  // Beyond a quarter turn the tangent changes sign; callers reach over an edge by a few cells only.
  const double a = (column / n - 0.5) * kFaceAngle;
  const double b = (row / n - 0.5) * kFaceAngle;
  Eigen::Vector3d direction;
  direction[axes[0]] = along;
  direction[axes[1]] = std::tan(a);
  direction[axes[2]] = std::tan(b);
  return direction.normalized();
}

Eigen::Vector3d CubeMap::DirectionOf(int cell) const {
  return DirectionOf(cell / (n_ * n_), cell % n_ + 0.5, cell / n_ % n_ + 0.5, n_);
}

double CubeMap::SolidAngle(int cell) const {
  // The integral over a cell of the solid angle has a closed form at the corners of its rectangle on the cube.
  const auto corner = [](double x, double y) { return std::atan2(x * y, std::sqrt(1 + x * x + y * y)); };
  const auto edge = [this](int k) { return std::tan((static_cast<double>(k) / n_ - 0.5) * kFaceAngle); };
  const int column = cell % n_;
  const int row = cell / n_ % n_;
  const double x0 = edge(column), x1 = edge(column + 1), y0 = edge(row), y1 = edge(row + 1);
  return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
}

int CubeMap::Neighbour(int cell, int columns, int rows) const {
  const int face = cell / (n_ * n_);
  const int column = cell % n_ + columns;
  const int row = cell / n_ % n_ + rows;
  if (column >= 0 && column < n_ && row >= 0 && row < n_) return (face * n_ + row) * n_ + column;
  return CellOf(DirectionOf(face, column + 0.5, row + 0.5, n_).cast<float>());
}

}  // namespace drupe
