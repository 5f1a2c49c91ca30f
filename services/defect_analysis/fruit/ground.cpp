#include "defect_analysis/fruit/ground.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <random>

namespace drupe {
namespace {

constexpr int kGroundSample = 4000;
constexpr int kTrials = 300;
constexpr double kDistanceShare = 0.005;  // of the cloud's diagonal
constexpr double kMinShare = 0.125;

std::vector<Eigen::Vector3d> Sample(const PointCloud& cloud) {
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kGroundSample);
  std::vector<Eigen::Vector3d> sample;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    if (cloud.positions[i].allFinite()) sample.push_back(cloud.positions[i].cast<double>());
  }
  return sample;
}

int CountInliers(const std::vector<Eigen::Vector3d>& points, const Ground& plane, double distance) {
  return static_cast<int>(std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& x) {
    return std::abs(plane.normal.dot(x) - plane.offset) < distance;
  }));
}

std::optional<Ground> PlaneThrough(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  if (normal.norm() < 1e-12) return std::nullopt;
  return Ground{normal.normalized(), normal.normalized().dot(a)};
}

Ground Refine(const std::vector<Eigen::Vector3d>& points, const Ground& plane, double distance) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  int count = 0;
  for (const Eigen::Vector3d& x : points) {
    if (std::abs(plane.normal.dot(x) - plane.offset) >= distance) continue;
    mean += x;
    moment += x * x.transpose();
    ++count;
  }
  mean /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment / count - mean * mean.transpose());
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

// The fruit is on the cameras' side; without cameras, on the side of most points.
Ground TurnUp(Ground plane, const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector3d>& cameras) {
  double side = 0;
  for (const Eigen::Vector3d& x : cameras.empty() ? points : cameras) side += plane.normal.dot(x) - plane.offset;
  if (side < 0) plane = {-plane.normal, -plane.offset};
  return plane;
}

}  // namespace

std::optional<Ground> FindGround(const PointCloud& cloud, double size,
                                 const std::vector<Eigen::Vector3d>& camera_centres, std::uint64_t seed) {
  const std::vector<Eigen::Vector3d> points = Sample(cloud);
  if (points.size() < 100) return std::nullopt;
  std::mt19937_64 random(seed);
  const auto pick = [&]() -> const Eigen::Vector3d& { return points[random() % points.size()]; };
  const double distance = kDistanceShare * size;
  Ground best;
  int best_count = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const std::optional<Ground> plane = PlaneThrough(pick(), pick(), pick());
    const int count = plane ? CountInliers(points, *plane, distance) : 0;
    if (count > best_count) {
      best = *plane;
      best_count = count;
    }
  }
  if (best_count < kMinShare * static_cast<double>(points.size())) return std::nullopt;
  best = TurnUp(Refine(points, best, distance), points, camera_centres);
  const auto below = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& x) {
    return best.normal.dot(x) - best.offset < -2 * distance;
  });
  const auto above = static_cast<std::ptrdiff_t>(points.size()) - best_count - below;
  if (below > above) return std::nullopt;
  return best;
}

}  // namespace drupe
