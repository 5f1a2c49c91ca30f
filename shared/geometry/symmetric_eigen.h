#pragma once

#include <Eigen/Core>

namespace drupe {

/// Eigenvalues, ascending, and their vectors of norm 1, one a column.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// Of a symmetric matrix of any size, of which only the lower triangle is read. In one place, since every size that
/// Eigen is given takes seconds to compile (3 x 3 apart, which is quick).
SymmetricEigen DecomposeSymmetric(const Eigen::MatrixXd& matrix);

}  // namespace drupe
