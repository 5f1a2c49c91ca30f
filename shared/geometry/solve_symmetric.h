#pragma once

#include <Eigen/Core>
#include <limits>

namespace drupe {

/// x with normal * x = right, for a symmetric and positive semi-definite matrix of which only the lower triangle is
/// read (L D L^T). An unknown that nothing determines becomes 0. For the few unknowns of normal equations in inner
/// loops: plain loops of known length, where Eigen's LDLT takes seconds to compile for every N.
template <int N>
Eigen::Matrix<double, N, 1> SolveSymmetric(Eigen::Matrix<double, N, N> normal, Eigen::Matrix<double, N, 1> right) {
  double least[N], inverse[N];
  for (int k = 0; k < N; ++k) least[k] = N * std::numeric_limits<double>::epsilon() * normal(k, k);
  for (int k = 0; k < N; ++k) {
    const bool is_determined = normal(k, k) > least[k];
    inverse[k] = is_determined ? 1 / normal(k, k) : 0;
    for (int row = k + 1; row < N; ++row) {
      const double factor = normal(row, k) * inverse[k];
      for (int column = k + 1; column <= row; ++column) normal(row, column) -= factor * normal(column, k);
      right[row] -= factor * right[k];
    }
  }
  for (int k = N - 1; k >= 0; --k) {
    double sum = right[k];
    for (int row = k + 1; row < N; ++row) sum -= normal(row, k) * right[row];
    right[k] = sum * inverse[k];
  }
  return right;
}

}  // namespace drupe
