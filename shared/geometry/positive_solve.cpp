#include "geometry/positive_solve.h"

#include <Eigen/Cholesky>

namespace drupe {

bool FactorPositive(Eigen::MatrixXd& matrix) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> solver(matrix);
  return solver.info() == Eigen::Success;
}

void SolveFactored(const Eigen::MatrixXd& factor, Eigen::Ref<Eigen::MatrixXd> rights) {
  factor.triangularView<Eigen::Lower>().solveInPlace(rights);
  factor.transpose().triangularView<Eigen::Upper>().solveInPlace(rights);
}

}  // namespace drupe
