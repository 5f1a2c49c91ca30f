#include "reconstruction/matching/seven_point.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "geometry/small_eigen.h"
#include "reconstruction/matching/null_space.h"

namespace drupe {
namespace {

/// A determinant of matrices of norm 1 below which there is nothing to solve for.
constexpr double kNoDeterminant = 1e-14;
constexpr double kRootTolerance = 1e-9;  ///< of RealRoots

}  // namespace

std::vector<Eigen::Matrix3d> SolveSevenPoint(const std::array<PointPair, 7>& pairs) {
  std::vector<Eigen::Matrix3d> f = EpipolarNullSpace(pairs);  // two
  if (std::abs(f[0].determinant()) > std::abs(f[1].determinant())) std::swap(f[0], f[1]);
  // det(f0 + x f1) is a cubic in x, known from its values at -1, 0 and 1 and from its leading coefficient.
  const double constant = f[0].determinant(), leading = f[1].determinant();
  if (!(std::abs(leading) > kNoDeterminant)) return {};
  const double plus = (f[0] + f[1]).determinant(), minus = (f[0] - f[1]).determinant();
  const double square = 0.5 * (plus + minus) - constant, linear = 0.5 * (plus - minus) - leading;
  std::vector<Eigen::Matrix3d> solutions;
  const double cubic[] = {constant, linear, square, leading};
  for (const double x : RealRoots(cubic, kRootTolerance)) {
    const Eigen::Matrix3d solution = f[0] + x * f[1];
    if (solution.allFinite()) solutions.push_back(solution.normalized());
  }
  return solutions;
}

}  // namespace drupe
