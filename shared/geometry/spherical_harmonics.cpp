#include "geometry/spherical_harmonics.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/positive_solve.h"

namespace drupe {
namespace {

int Index(int degree, int order) {
  return degree * degree + degree + order;
}

}  // namespace

void SphericalBasis(int degree, const Eigen::Vector3d& direction, Eigen::Ref<Eigen::VectorXd> values) {
  // Associated Legendre functions divided by sin(theta)^m, fully normalised, by the recurrence in l at fixed m (Holmes
  // and Featherstone 2002); sin(theta)^m cos(m phi) and sin(theta)^m sin(m phi) are the real and imaginary parts of
  // (x + i y)^m, so that the poles need no care.
  const double z = direction.z();
  double re = 1, im = 0;
  double sectoral = std::sqrt(1 / (4 * std::numbers::pi));
  for (int m = 0; m <= degree; ++m) {
    if (m > 0) {
      const double next_re = re * direction.x() - im * direction.y();
      im = re * direction.y() + im * direction.x();
      re = next_re;
      sectoral *= std::sqrt((2.0 * m + 1) / (2.0 * m)) * (m == 1 ? std::numbers::sqrt2 : 1.0);
    }
    double before = 0, current = sectoral;
    for (int l = m; l <= degree; ++l) {
      values[Index(l, m)] = current * re;
      if (m > 0) values[Index(l, -m)] = current * im;
      const double next_l = l + 1.0, mm = static_cast<double>(m) * m;
      const double a = std::sqrt((4 * next_l * next_l - 1) / (next_l * next_l - mm));
      const double b = l == m ? 0 : std::sqrt((static_cast<double>(l) * l - mm) / (4.0 * l * l - 1));
      const double next = a * (z * current - b * before);
      before = current;
      current = next;
    }
  }
}

Eigen::VectorXd SphericalFunction::At(const Eigen::Vector3d& direction) const {
  Eigen::VectorXd basis((degree_ + 1) * (degree_ + 1));
  SphericalBasis(degree_, direction, basis);
  return coefficients_.transpose() * basis;
}

Eigen::MatrixXd SphericalBasisRows(int degree, const std::vector<Eigen::Vector3d>& directions) {
  const int count = (degree + 1) * (degree + 1);
  Eigen::MatrixXd rows(directions.size(), count);
  Eigen::VectorXd values(count);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    SphericalBasis(degree, directions[i], values);
    rows.row(static_cast<Eigen::Index>(i)) = values.transpose();
  }
  return rows;
}

Result<SphericalFunction> FitSphericalFunction(int degree, const Eigen::MatrixXd& basis, const Eigen::MatrixXd& values,
                                               const Eigen::VectorXd& weights, double smoothness) {
  const int count = (degree + 1) * (degree + 1);
  const double weight_sum = weights.sum();
  if (basis.cols() < count || !(weight_sum > 0)) {
    return Unprocessable("too_few_directions", "too few directions to fit a smooth function on the sphere");
  }
  // In double precision: where nothing was seen only the small penalty decides, and it must not drown in rounding.
  const Eigen::MatrixXd weighted = weights.cwiseSqrt().asDiagonal() * basis.leftCols(count);
  Eigen::MatrixXd lhs = Eigen::MatrixXd::Zero(count, count);
  lhs.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
  for (int l = 0; l <= degree; ++l) {
    const double bend = static_cast<double>(l) * (l + 1);
    for (int m = -l; m <= l; ++m) lhs(Index(l, m), Index(l, m)) += weight_sum * (smoothness * bend * bend + 1e-12);
  }
  Eigen::MatrixXd solution = weighted.transpose() * (weights.cwiseSqrt().asDiagonal() * values);
  if (!FactorPositive(lhs)) {
    return Unprocessable("too_few_directions", "too few directions to fit a smooth function on the sphere");
  }
  SolveFactored(lhs, solution);
  return SphericalFunction(degree, std::move(solution));
}

}  // namespace drupe
