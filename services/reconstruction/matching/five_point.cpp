#include "reconstruction/matching/five_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/small_eigen.h"
#include "reconstruction/matching/null_space.h"

namespace drupe {
namespace {

constexpr double kRealTolerance = 1e-9;  ///< of RealEigenvalues

/// Polynomials in x, y, z by their coefficients. Linear: x, y, z, 1. Quadratic: x2 xy y2 xz yz z2 x y z 1. Cubic: x3
/// x2y xy2 y3 x2z xyz y2z xz2 yz2 z3, then the quadratic ones.
using Linear = std::array<double, 4>;
using Quadratic = std::array<double, 10>;
using Cubic = std::array<double, 20>;
using Cubics = std::array<Cubic, 10>;
/// E = x E0 + y E1 + z E2 + E3, each entry a linear polynomial.
using LinearMatrix = std::array<std::array<Linear, 3>, 3>;

/// Where the product of a quadratic's and a linear's monomial goes.
constexpr int kQuadraticOf[4][4] = {{0, 1, 3, 6}, {1, 2, 4, 7}, {3, 4, 5, 8}, {6, 7, 8, 9}};
constexpr int kCubicOf[10][4] = {{0, 1, 4, 10}, {1, 2, 5, 11},    {2, 3, 6, 12},    {4, 5, 7, 13},    {5, 6, 8, 14},
                                 {7, 8, 9, 15}, {10, 11, 13, 16}, {11, 12, 14, 17}, {13, 14, 15, 18}, {16, 17, 18, 19}};

/// Adds factor * a * b.
void AddProduct(double factor, const Linear& a, const Linear& b, Quadratic& sum) {
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) sum[kQuadraticOf[i][j]] += factor * a[i] * b[j];
  }
}

void AddProduct(const Quadratic& a, const Linear& b, Cubic& sum) {
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 4; ++j) sum[kCubicOf[i][j]] += a[i] * b[j];
  }
}

LinearMatrix PolynomialsOf(const std::vector<Eigen::Matrix3d>& basis) {
  LinearMatrix e;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 4; ++k) e[r][c][k] = basis[k](r, c);
    }
  }
  return e;
}

Cubic Determinant(const LinearMatrix& e) {
  Cubic sum{};
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, f = (c + 2) % 3;
    Quadratic minor{};
    AddProduct(1, e[1][d], e[2][f], minor);
    AddProduct(-1, e[1][f], e[2][d], minor);
    AddProduct(minor, e[0][c], sum);
  }
  return sum;
}

/// The ten cubics: det E = 0 and E E^T E - trace(E E^T) E / 2 = 0.
Cubics CubicConstraints(const LinearMatrix& e) {
  std::array<std::array<Quadratic, 3>, 3> eet{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) AddProduct(1, e[r][k], e[c][k], eet[r][c]);
    }
  }
  for (int m = 0; m < 10; ++m) {
    const double half_trace = 0.5 * (eet[0][0][m] + eet[1][1][m] + eet[2][2][m]);
    for (int i = 0; i < 3; ++i) eet[i][i][m] -= half_trace;
  }
  Cubics constraints{};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 3; ++k) AddProduct(eet[r][k], e[k][c], constraints[3 * r + c]);
    }
  }
  constraints[9] = Determinant(e);
  return constraints;
}

/// Gauss-Jordan elimination with partial pivoting: the first ten columns become the identity. Infinite where they are
/// singular.
void Reduce(Cubics& rows) {
  for (int k = 0; k < 10; ++k) {
    const auto larger = [k](const Cubic& a, const Cubic& b) { return std::abs(a[k]) < std::abs(b[k]); };
    std::swap(rows[k], *std::max_element(rows.begin() + k, rows.end(), larger));
    const double inverse = 1 / rows[k][k];
    for (int c = k; c < 20; ++c) rows[k][c] *= inverse;
    for (int r = 0; r < 10; ++r) {
      if (r == k) continue;
      const double factor = rows[r][k];
      for (int c = k; c < 20; ++c) rows[r][c] -= factor * rows[k][c];
    }
  }
}

/// Multiplication by x in the basis x2 xy y2 xz yz z2 x y z 1 of what the constraints leave.
SmallMatrix ActionMatrix(Cubics constraints) {
  Reduce(constraints);
  SmallMatrix action = SmallMatrix::Zero(10, 10);
  constexpr int kCubicRow[6] = {0, 1, 2, 4, 5, 7};  // x times x2 xy y2 xz yz z2
  for (int i = 0; i < 6; ++i) {
    for (int c = 0; c < 10; ++c) action(i, c) = -constraints[kCubicRow[i]][10 + c];
  }
  action(6, 0) = action(7, 1) = action(8, 3) = action(9, 6) = 1;
  return action;
}

/// The eigenvector of an eigenvalue: the ten monomials at a solution.
SmallVector MonomialsAt(SmallMatrix action, double eigenvalue) {
  for (int i = 0; i < 10; ++i) action(i, i) -= eigenvalue;
  return NullVector(action);
}

}  // namespace

std::vector<Eigen::Matrix3d> SolveFivePoint(const std::array<PointPair, 5>& pairs) {
  const std::vector<Eigen::Matrix3d> basis = EpipolarNullSpace(pairs);
  const SmallMatrix action = ActionMatrix(CubicConstraints(PolynomialsOf(basis)));
  std::vector<Eigen::Matrix3d> solutions;
  for (const double eigenvalue : RealEigenvalues(action, kRealTolerance)) {
    const SmallVector v = MonomialsAt(action, eigenvalue);
    if (std::abs(v[9]) < 1e-12 * v.norm()) continue;
    const Eigen::Matrix3d e = (v[6] * basis[0] + v[7] * basis[1] + v[8] * basis[2]) / v[9] + basis[3];
    if (e.allFinite()) solutions.push_back(e.normalized());
  }
  return solutions;
}

}  // namespace drupe
