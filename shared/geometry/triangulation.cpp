#include "geometry/triangulation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <vector>

#include "geometry/solve_symmetric.h"

namespace drupe {
namespace {

/// Least squared distance from the rays.
std::optional<Eigen::Vector3d> NearestToRays(std::span<const RayObservation> observations) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const RayObservation& observation : observations) {
    const Eigen::Vector3d ray =
        (observation.cam_from_world.rotation.transpose() * observation.xy.homogeneous()).normalized();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose();
    normal += across;
    right += across * observation.cam_from_world.Centre();
  }
  // The determinant is about count^2 sin^2(angle); rays within 0.01 degree of each other do not meet anywhere.
  if (normal.determinant() < 1e-8 * observations.size()) return std::nullopt;
  return normal.inverse() * right;
}

/// One Gauss-Newton step on the reprojection error; nothing when a camera has the point behind it.
std::optional<Eigen::Vector3d> Step(std::span<const RayObservation> observations, const Eigen::Vector3d& point) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const RayObservation& observation : observations) {
    const Eigen::Vector3d p = observation.cam_from_world * point;
    if (p.z() <= 0) return std::nullopt;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
    const Eigen::Matrix<double, 2, 3> jacobian = projection * observation.cam_from_world.rotation;
    normal.noalias() += jacobian.transpose() * jacobian;
    right.noalias() += jacobian.transpose() * (observation.xy - p.hnormalized());
  }
  return SolveSymmetric(normal, right);
}

}  // namespace

std::optional<Eigen::Vector3d> Triangulate(std::span<const RayObservation> observations) {
  if (observations.size() < 2) return std::nullopt;
  std::optional<Eigen::Vector3d> point = NearestToRays(observations);
  if (!point) return std::nullopt;
  constexpr int kMaxSteps = 5;
  for (int i = 0; i < kMaxSteps; ++i) {
    const auto step = Step(observations, *point);
    if (!step || !step->allFinite()) return std::nullopt;
    *point += *step;
    if (step->squaredNorm() < 1e-16 * point->squaredNorm()) break;
  }
  for (const RayObservation& observation : observations) {
    if ((observation.cam_from_world * *point).z() <= 0) return std::nullopt;
  }
  return point;
}

double ReprojectionError(const RayObservation& observation, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = observation.cam_from_world * point;
  if (p.z() <= 0) return std::numeric_limits<double>::infinity();
  return (p.hnormalized() - observation.xy).norm();
}

double SmallestRayCosine(std::span<const RayObservation> observations, const Eigen::Vector3d& point) {
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(observations.size());
  for (const RayObservation& observation : observations) {
    rays.push_back((observation.cam_from_world.Centre() - point).normalized());
  }
  double smallest = 1;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t k = i + 1; k < rays.size(); ++k) smallest = std::min(smallest, rays[i].dot(rays[k]));
  }
  return smallest;
}

}  // namespace drupe
