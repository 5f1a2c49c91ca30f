#include "reconstruction/clusters/rotation_averaging.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace drupe {
namespace {

constexpr int kMaxIterations = 30;
constexpr double kConvergedRad = 1e-5;

Eigen::Vector3d LogOf(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Eigen::Matrix3d ExpOf(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

/// Grows the tree of largest weights (Prim 1957) from every image that no tree has reached, and chains the rotations.
std::vector<Eigen::Matrix3d> ChainAlongTree(int image_count, const std::vector<RelativeRotation>& measured,
                                            std::vector<std::uint8_t>& is_root) {
  std::vector<Eigen::Matrix3d> rotations(image_count, Eigen::Matrix3d::Identity());
  std::vector<std::uint8_t> reached(image_count, 0);
  is_root.assign(image_count, 0);
  for (int root = 0; root < image_count; ++root) {
    if (reached[root]) continue;
    reached[root] = is_root[root] = 1;
    while (true) {
      const RelativeRotation* best = nullptr;
      for (const RelativeRotation& m : measured) {
        if (reached[m.first] != reached[m.second] && (best == nullptr || m.weight > best->weight)) best = &m;
      }
      if (best == nullptr) break;
      if (reached[best->first]) {
        rotations[best->second] = best->second_from_first * rotations[best->first];
      } else {
        rotations[best->first] = best->second_from_first.transpose() * rotations[best->second];
      }
      reached[best->first] = reached[best->second] = 1;
    }
  }
  return rotations;
}

/// One step of reweighted least squares on the tangent space; the largest turn it makes, radians. A turn d of an image
/// is applied on the left, so that a residual r = log(R_2^T M R_1), seen in the world, asks for d_2 - d_1 = r.
double Relax(const std::vector<RelativeRotation>& measured, const std::vector<std::uint8_t>& is_root, double scale_rad,
             std::vector<Eigen::Matrix3d>& rotations) {
  const auto n = static_cast<Eigen::Index>(rotations.size());
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 3);
  for (const RelativeRotation& m : measured) {
    // Turns of the world frame: R becomes R exp(-d).
    const Eigen::Vector3d residual = LogOf(rotations[m.second].transpose() * m.second_from_first * rotations[m.first]);
    const double ratio = residual.norm() / scale_rad;
    const double weight = m.weight / ((1 + ratio * ratio) * (1 + ratio * ratio));
    laplacian(m.first, m.first) += weight;
    laplacian(m.second, m.second) += weight;
    laplacian(m.first, m.second) -= weight;
    laplacian(m.second, m.first) -= weight;
    right.row(m.second) += weight * residual.transpose();
    right.row(m.first) -= weight * residual.transpose();
  }
  for (Eigen::Index i = 0; i < n; ++i) laplacian(i, i) += is_root[i] ? 1e12 : 1e-12;  // one image a part stays
  const Eigen::MatrixXd turns = laplacian.ldlt().solve(right);
  if (!turns.allFinite()) return 0;
  for (Eigen::Index i = 0; i < n; ++i) rotations[i] = rotations[i] * ExpOf(turns.row(i).transpose());
  return turns.rowwise().norm().maxCoeff();
}

}  // namespace

std::vector<Eigen::Matrix3d> AverageRotations(int image_count, const std::vector<RelativeRotation>& measured,
                                              double scale_rad) {
  std::vector<std::uint8_t> is_root;
  std::vector<Eigen::Matrix3d> rotations = ChainAlongTree(image_count, measured, is_root);
  if (measured.empty()) return rotations;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (Relax(measured, is_root, scale_rad, rotations) < kConvergedRad) break;
  }
  return rotations;
}

double RotationResidual(const RelativeRotation& measured, const std::vector<Eigen::Matrix3d>& rotations) {
  return LogOf(rotations[measured.second].transpose() * measured.second_from_first * rotations[measured.first]).norm();
}

}  // namespace drupe
