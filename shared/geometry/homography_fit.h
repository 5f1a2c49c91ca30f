#pragma once

#include <Eigen/Core>

namespace drupe {

/// The homography between two planes by least squares (direct linear transformation, Hartley & Zisserman 2004, section
/// 4.1). Coordinates are expected to be about 1.
class HomographyFit {
 public:
  void Add(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  /// to ~ H from, of norm 1; from four places on.
  Eigen::Matrix3d Solve() const;

 private:
  // The blocks of the normal equations: the sums of a a^T for a = (from, 1), weighted by 1, x, y and x^2 + y^2 of `to`.
  Eigen::Matrix3d plain_ = Eigen::Matrix3d::Zero(), by_x_ = Eigen::Matrix3d::Zero(), by_y_ = Eigen::Matrix3d::Zero(),
                  by_square_ = Eigen::Matrix3d::Zero();
};

}  // namespace drupe
