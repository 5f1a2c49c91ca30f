#include "geometry/sim3.h"

#include <Eigen/SVD>

namespace drupe {

namespace {

Eigen::Vector3d Mean(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

Result<Sim3> FitSim3(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to) {
  const Status degenerate = Unprocessable("degenerate_alignment", "an alignment needs 3 points that are not on a line");
  if (from.size() != to.size() || from.size() < 3) return degenerate;
  const Eigen::Vector3d mean_from = Mean(from);
  const Eigen::Vector3d mean_to = Mean(to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    covariance += (to[i] - mean_to) * (from[i] - mean_from).transpose();
    variance += (from[i] - mean_from).squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d singular = svd.singularValues();
  if (!(variance > 0.0) || singular(1) < 1e-9 * singular(0)) return degenerate;
  Eigen::Vector3d signs(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1.0 : 1.0);
  Sim3 sim;
  sim.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  sim.scale = singular.dot(signs) / variance;
  sim.translation = mean_to - sim.scale * (sim.rotation * mean_from);
  return sim;
}

Rigid3 TransformPose(const Rigid3& cam_from_old, const Sim3& new_from_old) {
  const Eigen::Matrix3d rotation = cam_from_old.rotation * new_from_old.rotation.transpose();
  return {rotation, new_from_old.scale * cam_from_old.translation - rotation * new_from_old.translation};
}

}  // namespace drupe
