#include "reconstruction/dense/shading.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace drupe::dense {

namespace {

constexpr std::size_t kLeastShadedSamples = 1000;
constexpr int kIterations = 8;
constexpr double kScale = 0.08;  ///< of the logarithmic residuals that count in full (Cauchy weights)

using Basis = Eigen::Matrix<double, 9, 1>;

Basis BasisAt(const Eigen::Vector3d& n) {
  Basis basis;
  basis << 1, n.x(), n.y(), n.z(), n.x() * n.y(), n.x() * n.z(), n.y() * n.z(), n.x() * n.x() - n.y() * n.y(),
      3 * n.z() * n.z() - 1;
  return basis;
}

}  // namespace

ShadingModel ShadingModel::Fit(const std::vector<ShadingSample>& samples) {
  ShadingModel model;
  if (samples.size() < kLeastShadedSamples) return model;
  Eigen::Matrix<double, 9, 3> solution = Eigen::Matrix<double, 9, 3>::Zero();
  Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Identity() * 1e-6;
    Eigen::Matrix<double, 9, 3> right = Eigen::Matrix<double, 9, 3>::Zero();
    mean.setZero();
    double weights = 0;
    for (const ShadingSample& sample : samples) {
      const Basis basis = BasisAt(sample.normal_in_cam.cast<double>());
      const Eigen::RowVector3d value = sample.log_colour.matrix().cast<double>().transpose();
      const Eigen::RowVector3d fitted = basis.transpose() * solution;
      // Green is the channel with the least noise; one weight for all keeps the hue.
      const double residual = iteration == 0 ? 0 : (value.y() - fitted.y()) / kScale;
      const double weight = 1 / (1 + residual * residual);
      normal.noalias() += weight * basis * basis.transpose();
      right.noalias() += weight * basis * value;
      mean += weight * fitted;
      weights += weight;
    }
    mean /= weights;
    solution = normal.ldlt().solve(right);
  }
  solution.row(0) -= mean;
  model.coefficients_ = solution.cast<float>();
  return model;
}

Eigen::Array3f ShadingModel::Log(const Eigen::Vector3f& normal_in_cam) const {
  const Eigen::Matrix<float, 9, 1> basis = BasisAt(normal_in_cam.cast<double>()).cast<float>();
  return (coefficients_.transpose() * basis).array();
}

}  // namespace drupe::dense
