#include "defect_analysis/defects/plane_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

namespace drupe {
namespace {

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double offset = 0;
  double DistanceTo(const Eigen::Vector3d& x) const { return std::abs(normal.dot(x) - offset); }
};

double ExtentOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d low = points.front(), high = points.front();
  for (const Eigen::Vector3d& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).maxCoeff();
}

// Whether a plane faces as the skin does. Through a crack that runs round the fruit also a plane across the skin fits.
bool FacesOutward(const Plane& plane, const Eigen::Vector3d& outward) {
  constexpr double kLeastCosine = 0.5;
  return std::abs(plane.normal.dot(outward)) >= kLeastCosine * outward.norm();
}

Plane BestTrial(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& outward, double distance,
                int iterations, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto pick = [&]() -> const Eigen::Vector3d& { return points[random() % points.size()]; };
  Plane best;
  std::ptrdiff_t best_count = -1;
  for (int trial = 0; trial < iterations; ++trial) {
    const Eigen::Vector3d& a = pick();
    const Eigen::Vector3d normal = (pick() - a).cross(pick() - a);
    if (normal.norm() < 1e-12) continue;
    const Plane plane{normal.normalized(), normal.normalized().dot(a)};
    if (!FacesOutward(plane, outward)) continue;
    const auto count = std::count_if(points.begin(), points.end(),
                                     [&](const Eigen::Vector3d& x) { return plane.DistanceTo(x) <= distance; });
    if (count <= best_count) continue;
    best = plane;
    best_count = count;
  }
  return best;
}

Plane LeastSquares(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& x : points) mean += x / static_cast<double>(points.size());
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& x : points) moment += (x - mean) * (x - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment);
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return {normal, normal.dot(mean)};
}

}  // namespace

Result<DefectPlane> FitDefectPlane(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& outward,
                                   double noise_mm, const PlaneOptions& options, std::uint64_t seed) {
  if (points.size() < 3) return Unprocessable("degenerate_plane", "a plane needs three points");
  const double asked = options.distance_mm > 0 ? options.distance_mm : options.distance * ExtentOf(points);
  const double distance = std::max(asked, noise_mm);
  const Plane trial = BestTrial(points, outward, distance, options.iterations, seed);
  std::vector<Eigen::Vector3d> inliers;
  for (const Eigen::Vector3d& x : points) {
    if (trial.DistanceTo(x) <= distance) inliers.push_back(x);
  }
  if (trial.normal.isZero() || inliers.size() < 3) return Unprocessable("degenerate_plane", "the points fit no plane");
  Plane plane = LeastSquares(inliers);
  if (!FacesOutward(plane, outward)) plane = trial;
  if (plane.normal.dot(outward) < 0) plane = {-plane.normal, -plane.offset};
  DefectPlane result{.normal = plane.normal, .offset_mm = plane.offset};
  double squares = 0;
  for (const Eigen::Vector3d& x : inliers) squares += plane.DistanceTo(x) * plane.DistanceTo(x);
  result.rms_mm = std::sqrt(squares / static_cast<double>(inliers.size()));
  for (const Eigen::Vector3d& x : points)
    result.mean_abs_z_mm += plane.DistanceTo(x) / static_cast<double>(points.size());
  return result;
}

}  // namespace drupe
