#include "reconstruction/sparse/pose_estimation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/p3p.h"
#include "geometry/solve_symmetric.h"
#include "reconstruction/sparse/linearised_observation.h"
#include "reconstruction/sparse/random_sample.h"

namespace drupe {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

double SquaredError(const Rigid3& pose, const PointCorrespondence& c) {
  const Eigen::Vector3d p = pose * c.point;
  if (p.z() <= 0) return std::numeric_limits<double>::infinity();
  return (p.hnormalized() - c.xy).squaredNorm();
}

/// Sum of squared errors, each at most `limit`.
double TruncatedCost(const Rigid3& pose, std::span<const PointCorrespondence> all, double limit) {
  double cost = 0;
  for (const PointCorrespondence& c : all) cost += std::min(limit, SquaredError(pose, c));
  return cost;
}

int MarkInliers(const Rigid3& pose, std::span<const PointCorrespondence> all, double limit,
                std::vector<std::uint8_t>& is_inlier) {
  is_inlier.resize(all.size());
  int count = 0;
  for (std::size_t i = 0; i < all.size(); ++i) count += is_inlier[i] = SquaredError(pose, all[i]) <= limit;
  return count;
}

/// Gauss-Newton system of the robust cost at a pose; a step is a rotation vector and a translation applied on the left.
struct PoseSystem {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0;
};

void AddCorrespondence(const Rigid3& pose, const PointCorrespondence& c, double loss2, PoseSystem& system) {
  const Eigen::Vector3d rotated = pose.rotation * c.point, p = rotated + pose.translation;
  if (p.z() <= 0) return;
  const Eigen::Vector2d residual = p.hnormalized() - c.xy;
  const double weight = 1 / (1 + residual.squaredNorm() / loss2);
  const double iz = 1 / p.z();
  Eigen::Matrix<double, 2, 3> projection;
  projection << iz, 0, -p.x() * iz * iz, 0, iz, -p.y() * iz * iz;
  Eigen::Matrix<double, 2, 6> jacobian;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d row = projection.row(k);
    jacobian.row(k) << rotated.cross(row).transpose(), row.transpose();
  }
  system.hessian.noalias() += weight * jacobian.transpose() * jacobian;
  system.gradient.noalias() += weight * jacobian.transpose() * residual;
  system.cost += loss2 * std::log1p(residual.squaredNorm() / loss2);
}

PoseSystem BuildSystem(const Rigid3& pose, std::span<const PointCorrespondence> all, std::span<const std::uint8_t> use,
                       double loss2) {
  PoseSystem system;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (use.empty() || use[i]) AddCorrespondence(pose, all[i], loss2, system);
  }
  return system;
}

int NeededIterations(double inlier_share, const PoseEstimationOptions& options) {
  const double all_good = std::pow(inlier_share, 3);
  if (all_good > 1 - 1e-9) return 1;
  const double needed = std::log(1 - options.confidence) / std::log1p(-all_good);
  return static_cast<int>(std::min<double>(options.max_iterations, std::ceil(needed)));
}

}  // namespace

Rigid3 RefinePose(const Rigid3& cam_from_world, std::span<const PointCorrespondence> correspondences,
                  std::span<const std::uint8_t> use, double loss_scale) {
  const double loss2 = loss_scale * loss_scale;
  Rigid3 pose = cam_from_world;
  PoseSystem system = BuildSystem(pose, correspondences, use, loss2);
  double damping = 1e-6;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Matrix6d damped = system.hessian;
    damped.diagonal() *= 1 + damping;
    const Vector6d step = -SolveSymmetric(damped, system.gradient);
    if (!step.allFinite()) break;
    const Rigid3 candidate = ApplyStep(pose, step);
    PoseSystem next = BuildSystem(candidate, correspondences, use, loss2);
    if (next.cost > system.cost) {
      damping *= 10;
      if (damping > 1e6) break;
      continue;
    }
    const bool converged = system.cost - next.cost <= 1e-12 * system.cost;
    pose = candidate;
    system = next;
    damping = std::max(1e-9, damping * 0.1);
    if (converged) break;
  }
  return pose;
}

std::optional<PoseEstimate> EstimatePose(std::span<const PointCorrespondence> correspondences,
                                         const PoseEstimationOptions& options) {
  if (correspondences.size() < 4) return std::nullopt;
  const double limit = options.max_error * options.max_error;
  RandomSampler random(options.seed);
  PoseEstimate best;
  double best_cost = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> is_inlier;
  const auto consider = [&](const Rigid3& pose) {
    const double cost = TruncatedCost(pose, correspondences, limit);
    if (cost >= best_cost) return false;
    best_cost = cost;
    best.cam_from_world = pose;
    best.inlier_count = MarkInliers(pose, correspondences, limit, best.is_inlier);
    return true;
  };
  int needed = options.max_iterations;
  for (int iteration = 0; iteration < needed; ++iteration) {
    const auto picked = random.Distinct<3>(correspondences.size());
    const auto &c0 = correspondences[picked[0]], &c1 = correspondences[picked[1]], &c2 = correspondences[picked[2]];
    bool improved = false;
    for (const Rigid3& pose : SolveP3p({c0.point, c1.point, c2.point}, {c0.xy, c1.xy, c2.xy})) {
      improved = consider(pose) || improved;
    }
    if (!improved) continue;
    if (best.inlier_count >= 6) {
      is_inlier = best.is_inlier;
      consider(RefinePose(best.cam_from_world, correspondences, is_inlier, options.max_error));
    }
    needed = NeededIterations(static_cast<double>(best.inlier_count) / correspondences.size(), options);
  }
  if (best.inlier_count < 4) return std::nullopt;
  is_inlier = best.is_inlier;
  consider(RefinePose(best.cam_from_world, correspondences, is_inlier, 0.5 * options.max_error));
  return best;
}

}  // namespace drupe
