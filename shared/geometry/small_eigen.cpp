#include "geometry/small_eigen.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/reflection.h"

namespace drupe {
namespace {

/// A similar matrix that is zero below its first subdiagonal.
void MakeHessenberg(SmallMatrix& m) {
  const int n = static_cast<int>(m.rows());
  for (int k = 0; k + 2 < n; ++k) {
    const Reflection reflection(&m(k + 1, k), n - k - 1);
    for (int column = k; column < n; ++column) reflection.Apply(&m(k + 1, column));
    for (int row = 0; row < n; ++row) reflection.Apply(&m(row, k + 1), n);
    for (int row = k + 2; row < n; ++row) m(row, k) = 0;
  }
}

/// `scale` times those of the quasi-triangular matrix of a real Schur decomposition.
std::vector<double> RealOnDiagonal(const SmallMatrix& t, double scale, double tolerance) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < t.rows(); ++i) {
    if (i + 1 == t.rows() || t(i + 1, i) == 0) {
      values.push_back(scale * t(i, i));
      continue;
    }
    const double half = 0.5 * (t(i, i) - t(i + 1, i + 1)), real = scale * (t(i + 1, i + 1) + half);
    const double imaginary = scale * std::sqrt(std::abs(half * half + t(i + 1, i) * t(i, i + 1)));
    if (imaginary <= tolerance * (1 + std::abs(real))) values.insert(values.end(), 2, real);
    ++i;
  }
  return values;
}

/// Brings the largest of the entries from (k, k) on to (k, k).
void Pivot(SmallMatrix& m, int k, std::array<int, SmallMatrix::MaxRowsAtCompileTime>& place) {
  const int n = static_cast<int>(m.rows());
  int row = k, column = k;
  for (int c = k; c < n; ++c) {
    for (int r = k; r < n; ++r) {
      if (std::abs(m(r, c)) > std::abs(m(row, column))) row = r, column = c;
    }
  }
  for (int c = 0; c < n; ++c) std::swap(m(k, c), m(row, c));
  for (int r = 0; r < n; ++r) std::swap(m(r, k), m(r, column));
  std::swap(place[k], place[column]);
}

}  // namespace

std::vector<double> RealEigenvalues(SmallMatrix matrix, double tolerance) {
  double scale = 0;
  for (Eigen::Index i = 0; i < matrix.size(); ++i) {
    if (!std::isfinite(matrix.data()[i])) return {};
    scale = std::max(scale, std::abs(matrix.data()[i]));
  }
  if (scale == 0) return std::vector<double>(static_cast<std::size_t>(matrix.rows()), 0.0);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix.data()[i] /= scale;
  MakeHessenberg(matrix);
  Eigen::RealSchur<SmallMatrix> schur(matrix.rows());
  schur.computeFromHessenberg(matrix, matrix, false);
  if (schur.info() != Eigen::Success) return {};
  return RealOnDiagonal(schur.matrixT(), scale, tolerance);
}

SmallVector NullVector(SmallMatrix m) {
  const int n = static_cast<int>(m.rows());
  std::array<int, SmallMatrix::MaxRowsAtCompileTime> place;
  std::iota(place.begin(), place.end(), 0);
  for (int k = 0; k + 1 < n; ++k) {
    Pivot(m, k, place);
    for (int c = k + 1; c < n; ++c) {
      const double factor = m(k, c) / m(k, k);
      for (int r = k + 1; r < n; ++r) m(r, c) -= factor * m(r, k);
    }
  }
  SmallVector x(n);
  for (int k = n - 1; k >= 0; --k) {
    double sum = 0;
    for (int c = k + 1; c < n; ++c) sum += m(k, c) * x[place[c]];
    x[place[k]] = k == n - 1 ? 1 : -sum / m(k, k);
  }
  return x;
}

std::vector<double> RealRoots(std::span<const double> coefficients, double tolerance) {
  const int degree = static_cast<int>(coefficients.size()) - 1;
  SmallMatrix companion(degree, degree);
  for (int c = 0; c < degree; ++c) {
    for (int r = 0; r < degree; ++r) companion(r, c) = r == c + 1 ? 1 : 0;
  }
  for (int r = 0; r < degree; ++r) companion(r, degree - 1) = -coefficients[r] / coefficients[degree];
  return RealEigenvalues(companion, tolerance);
}

}  // namespace drupe
