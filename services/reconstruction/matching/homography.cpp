#include "reconstruction/matching/homography.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
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
    if (SquaredTransfer(h, pair) < max_error * max_error) explained.push_back(pair);
  }
  return explained;
}

/// Every n-th pair, so that about kMaxPairs are left.
std::vector<PointPair> Thinned(std::span<const PointPair> pairs) {
  std::vector<PointPair> points;
  const std::size_t stride = std::max<std::size_t>(1, pairs.size() / kMaxPairs);
  for (std::size_t i = 0; i < pairs.size(); i += stride) points.push_back(pairs[i]);
  return points;
}

}  // namespace

double SquaredTransfer(const Eigen::Matrix3d& homography, const PointPair& pair) {
  const Eigen::Vector3d mapped = homography * pair.first.homogeneous();
  if (std::abs(mapped.z()) < 1e-12) return std::numeric_limits<double>::infinity();
  return (mapped.hnormalized() - pair.second).squaredNorm();
}

Eigen::Matrix3d RefineHomography(const Eigen::Matrix3d& start, std::span<const PointPair> pairs, double max_error) {
  const std::vector<PointPair> explained = ExplainedBy(start, pairs, max_error);
  if (explained.size() < kSample) return start;
  const Eigen::Matrix3d refined = FitHomography(explained);
  return ExplainedBy(refined, pairs, max_error).size() < explained.size() ? start : refined;
}

std::optional<Homography> EstimateHomography(std::span<const PointPair> pairs, double max_error, std::uint64_t seed) {
  const std::vector<PointPair> points = Thinned(pairs);
  if (points.size() < kSample) return std::nullopt;
  std::mt19937_64 random(seed);
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  std::size_t most = 0;
  for (int iteration = 0; iteration < kIterations && most < points.size(); ++iteration) {
    std::vector<PointPair> sample;
    for (const std::size_t i : DrawDistinct<kSample>(points.size(), random)) sample.push_back(points[i]);
    const std::vector<PointPair> explained = ExplainedBy(FitHomography(sample), points, max_error);
    if (explained.size() <= most || explained.size() < kSample) continue;
    const Eigen::Matrix3d refined = FitHomography(explained);
    const std::size_t count = ExplainedBy(refined, points, max_error).size();
    if (count <= most) continue;
    most = count;
    best = refined;
  }
  return Homography{best, static_cast<double>(most) / static_cast<double>(points.size())};
}

std::vector<Rigid3> PosesFromHomography(const Eigen::Matrix3d& homography) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares(homography.transpose() * homography);
  const Eigen::Vector3d& lambda = squares.eigenvalues();  // ascending
  if (!(lambda[1] > 0)) return {};
  Eigen::Matrix3d h = homography / std::sqrt(lambda[1]);
  if (h.determinant() < 0) h = -h;
  const double large = lambda[2] / lambda[1] - 1, small = 1 - lambda[0] / lambda[1];
  if (large + small < 1e-9) return {};
  const Eigen::Vector3d v1 = squares.eigenvectors().col(2), v2 = squares.eigenvectors().col(1),
                        v3 = squares.eigenvectors().col(0);
  std::vector<Rigid3> poses;
  for (const double sign : {1.0, -1.0}) {
    // v2 and u span a plane in which h keeps lengths and angles: what it does there is the rotation.
    const Eigen::Vector3d u = (std::sqrt(small) * v1 + sign * std::sqrt(large) * v3) / std::sqrt(large + small);
    Eigen::Matrix3d before, after;
    before << v2, u, v2.cross(u);
    after << h * v2, h * u, (h * v2).cross(h * u);
    const Eigen::Matrix3d rotation = after * before.transpose();
    const Eigen::Vector3d translation = (h - rotation) * before.col(2);
    if (translation.norm() > 1e-9) poses.push_back({rotation, translation.normalized()});
  }
  return poses;
}

}  // namespace drupe
