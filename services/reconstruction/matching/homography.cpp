#include "reconstruction/matching/homography.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "reconstruction/matching/ransac.h"

namespace drupe {
namespace {

constexpr int kSample = 4;
constexpr int kIterations = 100;
/// A share needs no more points than this.
constexpr std::size_t kMaxPairs = 600;

/// Least squares solution of second ~ H first (direct linear transformation).
Eigen::Matrix3d FitHomography(std::span<const PointPair> pairs) {
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d a = pair.first.homogeneous();
    Eigen::Matrix<double, 2, 9> rows;
    rows << a.transpose(), Eigen::RowVector3d::Zero(), -pair.second.x() * a.transpose(), Eigen::RowVector3d::Zero(),
        a.transpose(), -pair.second.y() * a.transpose();
    normal.noalias() += rows.transpose() * rows;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d homography;
  homography << h.head<3>().transpose(), h.segment<3>(3).transpose(), h.tail<3>().transpose();
  return homography;
}

std::vector<PointPair> ExplainedBy(const Eigen::Matrix3d& h, std::span<const PointPair> pairs, double max_error) {
  std::vector<PointPair> explained;
  for (const PointPair& pair : pairs) {
    const Eigen::Vector3d mapped = h * pair.first.homogeneous();
    if (std::abs(mapped.z()) < 1e-12) continue;
    if ((mapped.hnormalized() - pair.second).squaredNorm() < max_error * max_error) explained.push_back(pair);
  }
  return explained;
}

}  // namespace

double HomographyInlierShare(std::span<const PointPair> pairs, double max_error, std::uint64_t seed) {
  std::vector<PointPair> points;
  const std::size_t stride = std::max<std::size_t>(1, pairs.size() / kMaxPairs);
  for (std::size_t i = 0; i < pairs.size(); i += stride) points.push_back(pairs[i]);
  if (points.size() < kSample) return 0;
  std::mt19937_64 random(seed);
  std::size_t most = 0;
  for (int iteration = 0; iteration < kIterations && most < points.size(); ++iteration) {
    std::vector<PointPair> sample;
    for (const std::size_t i : DrawDistinct<kSample>(points.size(), random)) sample.push_back(points[i]);
    std::vector<PointPair> explained = ExplainedBy(FitHomography(sample), points, max_error);
    if (explained.size() <= most || explained.size() < kSample) continue;
    explained = ExplainedBy(FitHomography(explained), points, max_error);
    most = std::max(most, explained.size());
  }
  return static_cast<double>(most) / static_cast<double>(points.size());
}

}  // namespace drupe
