#include "reconstruction/dense/smooth_normals.h"

namespace drupe::dense {

namespace {

constexpr double kSameSide = 0.5;        ///< cosine between a point's normal and that of its surroundings
constexpr double kLeastAgreement = 0.8;  ///< length of the mean normal: below it there is more than one surface
constexpr double kLeastSpread = 1e-9;    ///< of the positions' variance, of their mean square: below it is rounding

}  // namespace

void SmoothNormals::Moments::Add(const Moments& other, double weight) {
  count += weight * other.count;
  position += weight * other.position;
  normal += weight * other.normal;
  position2 += weight * other.position2;
  normal_position += weight * other.normal_position;
}

SmoothNormals::SmoothNormals(const SurfaceGrid& grid, const std::vector<Eigen::Vector3f>& positions,
                             const std::vector<Eigen::Vector3f>& normals)
    : cells_(grid.cell_count()) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Eigen::Vector3d position = positions[i].cast<double>(), normal = normals[i].cast<double>();
    cells_[grid.CellOf(positions[i])].Add({1, position, normal, position.squaredNorm(), normal.dot(position)}, 1);
  }
}

Eigen::Vector3f SmoothNormals::At(const SurfaceGrid::Place& place, const Eigen::Vector3f& position,
                                  const Eigen::Vector3f& own) const {
  Moments sum;
  for (int corner = 0; corner < 8; ++corner) {
    if (place.cells[corner] != SurfaceGrid::kNone) sum.Add(cells_[place.cells[corner]], place.weights[corner]);
  }
  if (!(sum.count > 0)) return own;
  const Eigen::Vector3d middle = sum.position / sum.count, mean = sum.normal / sum.count;
  const double spread = sum.position2 / sum.count - middle.squaredNorm();
  const double curvature = spread > kLeastSpread * sum.position2 / sum.count
                               ? (sum.normal_position / sum.count - mean.dot(middle)) / spread
                               : 0;
  const Eigen::Vector3d fitted = mean + curvature * (position.cast<double>() - middle);
  const double length = fitted.norm();
  if (mean.norm() < kLeastAgreement || !(fitted.dot(own.cast<double>()) > kSameSide * length)) return own;
  return (fitted / length).cast<float>();
}

}  // namespace drupe::dense
