#include "reconstruction/matching/homography.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "geometry/homography_fit.h"
#include "reconstruction/matching/ransac.h"

namespace drupe {
namespace {

constexpr int kFourPoints = 4;
constexpr int kIterations = 100;
/// A share needs no more points than this.
constexpr std::size_t kMaxPairs = 600;

Eigen::Matrix3d FitHomography(std::span<const PointPair> pairs) {
  HomographyFit fit;
  for (const PointPair& pair : pairs) fit.Add(pair.first, pair.second);
  return fit.Solve();
}

std::size_t CountExplained(const Eigen::Matrix3d& h, std::span<const PointPair> pairs, double max_error) {
  const auto is_explained = [&](const PointPair& pair) { return SquaredTransfer(h, pair) < max_error * max_error; };
  return static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), is_explained));
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
  if (explained.size() < kFourPoints) return start;
  const Eigen::Matrix3d refined = FitHomography(explained);
  return CountExplained(refined, pairs, max_error) < explained.size() ? start : refined;
}

std::optional<Homography> EstimateHomography(std::span<const PointPair> pairs, double max_error, std::uint64_t seed) {
  const std::vector<PointPair> points = Thinned(pairs);
  if (points.size() < kFourPoints) return std::nullopt;
  std::mt19937_64 random(seed);
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  std::size_t most = 0;
  for (int iteration = 0; iteration < kIterations && most < points.size(); ++iteration) {
    std::vector<PointPair> sample;
    for (const std::size_t i : DrawDistinct<kFourPoints>(points.size(), random)) sample.push_back(points[i]);
    const Eigen::Matrix3d first = FitHomography(sample);
    const std::size_t explained = CountExplained(first, points, max_error);
    if (explained <= most || explained < kFourPoints) continue;
    const Eigen::Matrix3d refined = FitHomography(ExplainedBy(first, points, max_error));
    const std::size_t count = CountExplained(refined, points, max_error);
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
