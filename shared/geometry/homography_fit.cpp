#include "geometry/homography_fit.h"

#include "geometry/symmetric_eigen.h"

namespace drupe {

void HomographyFit::Add(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector3d a(from.x(), from.y(), 1);
  const Eigen::Matrix3d square = a * a.transpose();
  plain_ += square;
  by_x_ += to.x() * square;
  by_y_ += to.y() * square;
  by_square_ += to.squaredNorm() * square;
}

Eigen::Matrix3d HomographyFit::Solve() const {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(9, 9);
  normal.block<3, 3>(0, 0) = normal.block<3, 3>(3, 3) = plain_;
  normal.block<3, 3>(6, 0) = -by_x_;
  normal.block<3, 3>(6, 3) = -by_y_;
  normal.block<3, 3>(6, 6) = by_square_;
  const SymmetricEigen eigen = DecomposeSymmetric(normal);
  Eigen::Matrix3d homography;
  for (int i = 0; i < 9; ++i) homography(i / 3, i % 3) = eigen.vectors(i, 0);
  return homography;
}

}  // namespace drupe
