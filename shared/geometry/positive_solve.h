#pragma once

#include <Eigen/Core>

namespace drupe {

/// Cholesky's factor of a positive definite matrix of any size, over its lower triangle. False when it is not positive
/// definite. In one place, since every file that factorises takes seconds longer to compile.
bool FactorPositive(Eigen::MatrixXd& matrix);

/// Overwrites right sides (one a column) by the solutions, given the factor.
void SolveFactored(const Eigen::MatrixXd& factor, Eigen::Ref<Eigen::MatrixXd> rights);

}  // namespace drupe
