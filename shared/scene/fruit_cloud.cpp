#include "scene/fruit_cloud.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

namespace drupe {

FruitSurface::FruitSurface(const Eigen::Vector3d& centre, CubeTable<float> radius)
    : centre_(centre), radius_(std::move(radius)) {
  Integrate();
}

Eigen::Vector3d FruitSurface::PointAt(const Eigen::Vector3d& direction) const {
  return centre_ + static_cast<double>(RadiusAt(direction.cast<float>())) * direction.normalized();
}

Eigen::Vector3d FruitSurface::NormalAt(const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d d = direction.normalized();
  const Eigen::Vector3d a = d.unitOrthogonal();
  const Eigen::Vector3d b = d.cross(a);
  const double step = radius_.map().CellAngle();
  const Eigen::Vector3d along_a = PointAt(d + step * a) - PointAt(d - step * a);
  const Eigen::Vector3d along_b = PointAt(d + step * b) - PointAt(d - step * b);
  return along_a.cross(along_b).normalized();
}

double FruitSurface::AreaPerSolidAngle(const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d d = direction.normalized();
  const double radius = RadiusAt(d.cast<float>());
  return radius * radius / std::max(0.1, d.dot(NormalAt(d)));
}

Eigen::Vector3d FruitSurface::Corner(int face, int column, int row) const {
  return radius_.Corner(face, column, row) * CubeMap::DirectionOf(face, column, row, radius_.map().n());
}

void FruitSurface::Integrate() {
  const CubeMap& map = radius_.map();
  const int n = map.n();
  double radius_sum = 0;
  for (int cell = 0; cell < map.size(); ++cell) {
    const int face = cell / (n * n), column = cell % n, row = cell / n % n;
    const Eigen::Vector3d p00 = Corner(face, column, row), p10 = Corner(face, column + 1, row);
    const Eigen::Vector3d p01 = Corner(face, column, row + 1), p11 = Corner(face, column + 1, row + 1);
    area_ += 0.5 * ((p10 - p00).cross(p11 - p00).norm() + (p11 - p00).cross(p01 - p00).norm());
    volume_ += (std::abs(p00.dot(p10.cross(p11))) + std::abs(p00.dot(p11.cross(p01)))) / 6;
    radius_sum += map.SolidAngle(cell) * (p00 + p11).norm() / 2;
  }
  mean_radius_ = radius_sum / (4 * std::numbers::pi);
}

}  // namespace drupe
