#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "defect_analysis/defects/contour.h"

namespace drupe {
namespace {

// The degree + 1 uniform B-splines that are not zero at `t` (0..1) of a span, first the one that ends there (Cox-de
// Boor on integer knots).
Eigen::VectorXd BasisAt(double t, int degree) {
  Eigen::VectorXd basis = Eigen::VectorXd::Zero(degree + 1);
  basis[0] = 1;
  for (int k = 1; k <= degree; ++k) {
    double carried = 0;
    for (int j = 0; j < k; ++j) {
      // Knots left and right of the span: t + j' with spacing one, so denominators are k.
      const double right = (j + 1 - t) / k;
      const double left = (t + k - 1 - j) / k;
      const double value = basis[j];
      basis[j] = carried + right * value;
      carried = left * value;
    }
    basis[k] = carried;
  }
  return basis;
}

std::vector<double> LengthParameters(const Polygon& polygon) {
  std::vector<double> at(polygon.size() + 1, 0);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    at[i + 1] = at[i] + (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  }
  for (double& value : at) value /= std::max(1e-12, at.back());
  return at;
}

Eigen::RowVectorXd Row(double parameter, int count, int degree) {
  const double place = parameter * count;
  const int span = std::min(static_cast<int>(place), count - 1);
  const Eigen::VectorXd basis = BasisAt(place - span, degree);
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(count);
  for (int k = 0; k <= degree; ++k) row[(span + k) % count] += basis[k];
  return row;
}

}  // namespace

Result<ClosedSpline> ClosedSpline::Fit(const Polygon& polygon, int control_points, int degree) {
  const int count = std::min(control_points, static_cast<int>(polygon.size()));
  if (count < degree + 1) return Unprocessable("degenerate_contour", "the contour has too few points for a spline");
  std::vector<double> parameters = LengthParameters(polygon);
  // In one place the last value is 1, which belongs to the first point again.
  parameters.pop_back();
  Eigen::MatrixXd rows(polygon.size(), count);
  Eigen::MatrixX2d targets(polygon.size(), 2);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = Row(parameters[i], count, degree);
    targets.row(static_cast<Eigen::Index>(i)) = polygon[i].transpose();
  }
  ClosedSpline spline;
  spline.degree_ = degree;
  const Eigen::MatrixXd normal = rows.transpose() * rows + 1e-9 * Eigen::MatrixXd::Identity(count, count);
  spline.control_ = normal.ldlt().solve(rows.transpose() * targets);
  spline.rms_ = std::sqrt((rows * spline.control_ - targets).rowwise().squaredNorm().mean());
  if (!spline.control_.allFinite()) return Unprocessable("degenerate_contour", "the contour is degenerate");
  return spline;
}

Polygon ClosedSpline::Sample(int samples_per_span) const {
  Polygon curve;
  const int count = ControlPointCount();
  for (int span = 0; span < count; ++span) {
    for (int k = 0; k < samples_per_span; ++k) {
      const Eigen::VectorXd basis = BasisAt(static_cast<double>(k) / samples_per_span, degree_);
      Eigen::Vector2d point = Eigen::Vector2d::Zero();
      for (int j = 0; j <= degree_; ++j) point += basis[j] * control_.row((span + j) % count).transpose();
      curve.push_back(point);
    }
  }
  return curve;
}

}  // namespace drupe
