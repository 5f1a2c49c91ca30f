#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/status.h"

namespace drupe {

/// Real orthonormal spherical harmonics: a smooth function on the sphere of directions, one column of coefficients for
/// each of its values. Coefficient number l * l + l + m for degree l and order m.
class SphericalFunction {
 public:
  SphericalFunction() = default;
  SphericalFunction(int degree, Eigen::MatrixXd coefficients)
      : degree_(degree), coefficients_(std::move(coefficients)) {}

  int degree() const { return degree_; }
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }  ///< (degree + 1)^2 rows
  /// The values in a direction of unit length.
  Eigen::VectorXd At(const Eigen::Vector3d& direction) const;

 private:
  int degree_ = 0;
  Eigen::MatrixXd coefficients_;
};

/// The (degree + 1)^2 basis functions in a direction of unit length.
void SphericalBasis(int degree, const Eigen::Vector3d& direction, Eigen::Ref<Eigen::VectorXd> values);

/// The basis in many directions: one row each.
Eigen::MatrixXd SphericalBasisRows(int degree, const std::vector<Eigen::Vector3d>& directions);

/// Weighted least squares with the smoothness penalty `smoothness` * sum (l (l + 1))^2 c^2 times the mean weight: the
/// energy of the bent thin plate on the sphere (Wahba 1981). Where nothing was seen, the function continues with least
/// bending. Rows of `basis` (from SphericalBasisRows, `degree` or higher), `values` and `weights` belong together.
/// Errors: 422 `too_few_directions`.
Result<SphericalFunction> FitSphericalFunction(int degree, const Eigen::MatrixXd& basis, const Eigen::MatrixXd& values,
                                               const Eigen::VectorXd& weights, double smoothness);

}  // namespace drupe
