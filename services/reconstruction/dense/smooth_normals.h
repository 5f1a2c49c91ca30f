#pragma once

#include <Eigen/Core>
#include <vector>

#include "reconstruction/dense/surface_grid.h"

namespace drupe::dense {

/// Normals without the noise of each point's own: about every place the normal as a linear function of the position, of
/// one curvature in all directions, fitted to the points of the cells about it. At the border of a cloud it is as good
/// as inside.
class SmoothNormals {
 public:
  /// `normals` of unit length, one for each position, which `grid` was made of.
  SmoothNormals(const SurfaceGrid& grid, const std::vector<Eigen::Vector3f>& positions,
                const std::vector<Eigen::Vector3f>& normals);

  /// The normal at a position, unit length. The own one where the surface around faces elsewhere, or is
  /// not one.
  Eigen::Vector3f At(const SurfaceGrid::Place& place, const Eigen::Vector3f& position,
                     const Eigen::Vector3f& own) const;

 private:
  /// Sums over the points of one cell.
  struct Moments {
    double count = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
    double position2 = 0;        ///< of |position|^2
    double normal_position = 0;  ///< of normal . position

    void Add(const Moments& other, double weight);
  };

  std::vector<Moments> cells_;
};

}  // namespace drupe::dense
