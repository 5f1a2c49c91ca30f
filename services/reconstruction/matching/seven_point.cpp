#include "reconstruction/matching/seven_point.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <utility>

namespace drupe {
namespace {

/// A determinant of matrices of norm 1 below which there is nothing to solve for.
constexpr double kNoDeterminant = 1e-14;

using Pencil = std::array<Eigen::Matrix3d, 2>;

/// Two matrices that span what the seven epipolar constraints leave open.
Pencil NullSpace(const std::array<PointPair, 7>& pairs) {
  Eigen::Matrix<double, 9, 7> constraints;
  for (int i = 0; i < 7; ++i) {
    const Eigen::Vector3d a = pairs[i].first.homogeneous(), b = pairs[i].second.homogeneous();
    for (int r = 0; r < 3; ++r) constraints.block<3, 1>(3 * r, i) = b[r] * a;
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 7>> qr(constraints);
  const Eigen::Matrix<double, 9, 9> q = qr.householderQ();
  Pencil pencil;
  for (int k = 0; k < 2; ++k) {
    for (int r = 0; r < 3; ++r) pencil[k].row(r) = q.block<3, 1>(3 * r, 7 + k).transpose();
  }
  return pencil;
}

/// The real roots of x^3 + c[2] x^2 + c[1] x + c[0].
std::vector<double> RealRoots(const Eigen::Vector3d& c) {
  Eigen::Matrix3d companion = Eigen::Matrix3d::Zero();
  companion(1, 0) = companion(2, 1) = 1;
  companion.col(2) = -c;
  const Eigen::EigenSolver<Eigen::Matrix3d> solver(companion, false);
  std::vector<double> roots;
  for (int i = 0; i < 3 && solver.info() == Eigen::Success; ++i) {
    const std::complex<double> root = solver.eigenvalues()[i];
    if (std::abs(root.imag()) <= 1e-9 * (1 + std::abs(root.real()))) roots.push_back(root.real());
  }
  return roots;
}

}  // namespace

std::vector<Eigen::Matrix3d> SolveSevenPoint(const std::array<PointPair, 7>& pairs) {
  Pencil f = NullSpace(pairs);
  if (std::abs(f[0].determinant()) > std::abs(f[1].determinant())) std::swap(f[0], f[1]);
  // det(f0 + x f1) is a cubic in x, known from its values at -1, 0 and 1 and from its leading coefficient.
  const double constant = f[0].determinant(), leading = f[1].determinant();
  if (!(std::abs(leading) > kNoDeterminant)) return {};
  const double plus = (f[0] + f[1]).determinant(), minus = (f[0] - f[1]).determinant();
  const double square = 0.5 * (plus + minus) - constant, linear = 0.5 * (plus - minus) - leading;
  std::vector<Eigen::Matrix3d> solutions;
  for (const double x : RealRoots({constant / leading, linear / leading, square / leading})) {
    const Eigen::Matrix3d solution = f[0] + x * f[1];
    if (solution.allFinite()) solutions.push_back(solution.normalized());
  }
  return solutions;
}

}  // namespace drupe
