#include "reconstruction/matching/five_point.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

namespace drupe {
namespace {

/// Polynomials in x, y, z by their coefficients. Linear: x, y, z, 1. Quadratic: x2 xy y2 xz yz z2 x y z 1. Cubic: x3
/// x2y xy2 y3 x2z xyz y2z xz2 yz2 z3, then the quadratic ones.
using Linear = Eigen::Matrix<double, 4, 1>;
using Quadratic = Eigen::Matrix<double, 10, 1>;
using Cubic = Eigen::Matrix<double, 20, 1>;
using Constraints = Eigen::Matrix<double, 10, 20>;
/// E = x E0 + y E1 + z E2 + E3, each entry a linear polynomial.
using LinearMatrix = std::array<std::array<Linear, 3>, 3>;

/// Where the product of a quadratic's and a linear's monomial goes.
constexpr int kQuadraticOf[4][4] = {{0, 1, 3, 6}, {1, 2, 4, 7}, {3, 4, 5, 8}, {6, 7, 8, 9}};
constexpr int kCubicOf[10][4] = {{0, 1, 4, 10}, {1, 2, 5, 11},    {2, 3, 6, 12},    {4, 5, 7, 13},    {5, 6, 8, 14},
                                 {7, 8, 9, 15}, {10, 11, 13, 16}, {11, 12, 14, 17}, {13, 14, 15, 18}, {16, 17, 18, 19}};

Quadratic operator*(const Linear& a, const Linear& b) {
  Quadratic product = Quadratic::Zero();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) product[kQuadraticOf[i][j]] += a[i] * b[j];
  }
  return product;
}

void AddProduct(const Quadratic& a, const Linear& b, Cubic& sum) {
  for (int i = 0; i < 10; ++i) {
    for (int j = 0; j < 4; ++j) sum[kCubicOf[i][j]] += a[i] * b[j];
  }
}

/// The four matrices that span what the five epipolar constraints leave open.
LinearMatrix NullSpace(const std::array<PointPair, 5>& pairs) {
  Eigen::Matrix<double, 9, 5> constraints;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d a = pairs[i].first.homogeneous(), b = pairs[i].second.homogeneous();
    for (int r = 0; r < 3; ++r) constraints.block<3, 1>(3 * r, i) = b[r] * a;
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 5>> qr(constraints);
  const Eigen::Matrix<double, 9, 9> q = qr.householderQ();
  LinearMatrix e;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) e[r][c] = q.block<1, 4>(3 * r + c, 5).transpose();
  }
  return e;
}

Cubic Determinant(const LinearMatrix& e) {
  Cubic sum = Cubic::Zero();
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3, f = (c + 2) % 3;
    AddProduct(e[1][d] * e[2][f] - e[1][f] * e[2][d], e[0][c], sum);
  }
  return sum;
}

/// The ten cubics: det E = 0 and E E^T E - trace(E E^T) E / 2 = 0.
Constraints CubicConstraints(const LinearMatrix& e) {
  std::array<std::array<Quadratic, 3>, 3> eet;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) eet[r][c] = e[r][0] * e[c][0] + e[r][1] * e[c][1] + e[r][2] * e[c][2];
  }
  const Quadratic half_trace = 0.5 * (eet[0][0] + eet[1][1] + eet[2][2]);
  for (int i = 0; i < 3; ++i) eet[i][i] -= half_trace;
  Constraints constraints;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      Cubic sum = Cubic::Zero();
      for (int k = 0; k < 3; ++k) AddProduct(eet[r][k], e[k][c], sum);
      constraints.row(3 * r + c) = sum.transpose();
    }
  }
  constraints.row(9) = Determinant(e).transpose();
  return constraints;
}

/// Multiplication by x in the basis x2 xy y2 xz yz z2 x y z 1 of what the constraints leave.
Eigen::Matrix<double, 10, 10> ActionMatrix(const Constraints& constraints) {
  const Eigen::Matrix<double, 10, 10> reduced =
      constraints.leftCols<10>().partialPivLu().solve(constraints.rightCols<10>());
  Eigen::Matrix<double, 10, 10> action = Eigen::Matrix<double, 10, 10>::Zero();
  constexpr int kCubicRow[6] = {0, 1, 2, 4, 5, 7};  // x times x2 xy y2 xz yz z2
  for (int i = 0; i < 6; ++i) action.row(i) = -reduced.row(kCubicRow[i]);
  action(6, 0) = action(7, 1) = action(8, 3) = action(9, 6) = 1;
  return action;
}

}  // namespace

std::vector<Eigen::Matrix3d> SolveFivePoint(const std::array<PointPair, 5>& pairs) {
  const LinearMatrix basis = NullSpace(pairs);
  const Eigen::Matrix<double, 10, 10> action = ActionMatrix(CubicConstraints(basis));
  if (!action.allFinite()) return {};
  const Eigen::EigenSolver<Eigen::Matrix<double, 10, 10>> solver(action);
  if (solver.info() != Eigen::Success) return {};
  std::vector<Eigen::Matrix3d> solutions;
  for (int i = 0; i < 10; ++i) {
    if (std::abs(solver.eigenvalues()[i].imag()) > 1e-9) continue;
    const Eigen::Matrix<double, 10, 1> v = solver.eigenvectors().col(i).real();
    if (std::abs(v[9]) < 1e-12) continue;
    const Linear at(v[6] / v[9], v[7] / v[9], v[8] / v[9], 1);
    Eigen::Matrix3d e;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) e(r, c) = basis[r][c].dot(at);
    }
    if (e.allFinite()) solutions.push_back(e / e.norm());
  }
  return solutions;
}

}  // namespace drupe
