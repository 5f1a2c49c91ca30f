#include "reconstruction/dense/unseen_side.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/robust.h"
#include "geometry/solve_symmetric.h"
#include "geometry/spherical_harmonics.h"

namespace drupe::dense {

namespace {

constexpr int kBands = 48, kSectors = 96;  ///< cells of directions: bands of equal area, sectors of azimuth
constexpr int kCells = kBands * kSectors;
constexpr int kDegree = 8;
constexpr double kSmoothness = 1e-6;  ///< FitSphericalFunction's
constexpr int kRobustRounds = 5;
constexpr double kLeastSigma = 1e-4;  ///< of the logarithm of a radius
constexpr int kSamplesASide = 4;      ///< guessed points of a cell, along each of its sides
constexpr double kMostInward = 0.02;  ///< share of points whose normal may point towards the middle

/// The direction in the cells' grid at a band and sector, which need not be whole.
Eigen::Vector3d DirectionAt(double band, double sector) {
  const double z = 1 - 2 * band / kBands, azimuth = 2 * std::numbers::pi * sector / kSectors;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}

int CellOf(const Eigen::Vector3d& direction) {
  const int band = std::clamp(static_cast<int>((1 - direction.z()) / 2 * kBands), 0, kBands - 1);
  const double turn = std::atan2(direction.y(), direction.x()) / (2 * std::numbers::pi);
  const int sector = static_cast<int>((turn < 0 ? turn + 1 : turn) * kSectors) % kSectors;
  return band * kSectors + sector;
}

/// The middle of the sphere that fits best: |p|^2 = 2 c . p + const.
Eigen::Vector3d MiddleOf(const PointCloud& cloud) {
  Eigen::Matrix4d lhs = Eigen::Matrix4d::Zero();
  Eigen::Vector4d rhs = Eigen::Vector4d::Zero();
  const Eigen::Vector3d origin = cloud.positions.front().cast<double>();
  for (const Eigen::Vector3f& position : cloud.positions) {
    const Eigen::Vector3d p = position.cast<double>() - origin;
    const Eigen::Vector4d row(p.x(), p.y(), p.z(), 1);
    lhs += row * row.transpose();
    rhs += p.squaredNorm() * row;
  }
  return origin + 0.5 * SolveSymmetric(lhs, rhs).head<3>();
}

bool BulgesOutward(const PointCloud& cloud, const Eigen::Vector3d& middle) {
  const auto inward = std::count_if(cloud.normals.begin(), cloud.normals.end(), [&](const Eigen::Vector3f& normal) {
    const std::size_t i = static_cast<std::size_t>(&normal - cloud.normals.data());
    return normal.cast<double>().dot(cloud.positions[i].cast<double>() - middle) <= 0;
  });
  return static_cast<double>(inward) <= kMostInward * static_cast<double>(cloud.size());
}

/// The mean logarithm of the radius in each cell; 0 points: not seen.
struct SeenCells {
  std::vector<double> log_radius = std::vector<double>(kCells, 0);
  std::vector<int> points = std::vector<int>(kCells, 0);

  /// True when no point lies in the cell nor in those beside it.
  bool FarFromSeen(int band, int sector) const {
    for (int b = std::max(band - 1, 0); b <= std::min(band + 1, kBands - 1); ++b) {
      for (int s = sector - 1; s <= sector + 1; ++s) {
        if (points[b * kSectors + (s + kSectors) % kSectors] > 0) return false;
      }
    }
    return true;
  }
};

SeenCells CollectCells(const PointCloud& cloud, const Eigen::Vector3d& middle) {
  SeenCells seen;
  for (const Eigen::Vector3f& position : cloud.positions) {
    const Eigen::Vector3d out = position.cast<double>() - middle;
    const double radius = std::max(out.norm(), 1e-9);
    const int cell = CellOf(out / radius);
    seen.log_radius[cell] += std::log(radius);
    ++seen.points[cell];
  }
  for (int cell = 0; cell < kCells; ++cell) seen.log_radius[cell] /= std::max(seen.points[cell], 1);
  return seen;
}

/// Directions of the seen cells, one of norm 1 for each, the logarithms of their radii, and how much they count: those
/// that hold few points for less, since what lies alone beyond the edge of the seen is seldom skin.
struct SeenSamples {
  std::vector<Eigen::Vector3d> directions;
  Eigen::VectorXd log_radii, weights;
};

SeenSamples SamplesOf(const SeenCells& seen) {
  SeenSamples samples;
  std::vector<double> radii, counts;
  for (int cell = 0; cell < kCells; ++cell) {
    if (seen.points[cell] == 0) continue;
    samples.directions.push_back(DirectionAt(cell / kSectors + 0.5, cell % kSectors + 0.5));
    radii.push_back(seen.log_radius[cell]);
    counts.push_back(seen.points[cell]);
  }
  const double usual = Median(counts);
  for (double& count : counts) count = std::min(1.0, count / usual);
  const auto size = static_cast<Eigen::Index>(radii.size());
  samples.log_radii = Eigen::Map<const Eigen::VectorXd>(radii.data(), size);
  samples.weights = Eigen::Map<const Eigen::VectorXd>(counts.data(), size);
  return samples;
}

/// By iterative reweighting: a few wrong points beyond the edge of the seen would bend all of what is continued there.
Result<SphericalFunction> FitSeen(const SeenCells& seen) {
  const SeenSamples samples = SamplesOf(seen);
  const Eigen::MatrixXd basis = SphericalBasisRows(kDegree, samples.directions);
  Eigen::VectorXd weights = samples.weights;
  Result<SphericalFunction> fit = FitSphericalFunction(kDegree, basis, samples.log_radii, weights, kSmoothness);
  for (int round = 0; round < kRobustRounds && fit.ok(); ++round) {
    std::vector<double> residuals;
    for (std::size_t i = 0; i < samples.directions.size(); ++i) {
      residuals.push_back(samples.log_radii[static_cast<Eigen::Index>(i)] - fit->At(samples.directions[i])[0]);
    }
    const double sigma = std::max(RobustSigma(residuals), kLeastSigma);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      weights[row] = samples.weights[row] * TukeyWeight(residuals[i] / sigma);
    }
    fit = FitSphericalFunction(kDegree, basis, samples.log_radii, weights, kSmoothness);
  }
  return fit;
}

/// The point of the surface in a direction, and its normal from two points beside it.
void AddPoint(const SphericalFunction& log_radius, const Eigen::Vector3d& middle, const Eigen::Vector3d& direction,
              PointCloud* cloud) {
  constexpr double kStep = 1e-3;  // radians
  const auto at = [&](const Eigen::Vector3d& d) -> Eigen::Vector3d { return std::exp(log_radius.At(d)[0]) * d; };
  const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
  const Eigen::Vector3d here = at(direction);
  const Eigen::Vector3d along_u = at((direction + kStep * u).normalized()) - here;
  const Eigen::Vector3d along_v = at((direction + kStep * v).normalized()) - here;
  cloud->positions.push_back((middle + here).cast<float>());
  cloud->normals.push_back(along_u.cross(along_v).normalized().cast<float>());
}

}  // namespace

PointCloud GuessUnseenSide(const PointCloud& cloud) {
  PointCloud guessed;
  if (cloud.empty()) return guessed;
  const Eigen::Vector3d middle = MiddleOf(cloud);
  if (!middle.allFinite() || !BulgesOutward(cloud, middle)) return guessed;
  const SeenCells seen = CollectCells(cloud, middle);
  const Result<SphericalFunction> log_radius = FitSeen(seen);
  if (!log_radius.ok()) return guessed;
  for (int cell = 0; cell < kCells; ++cell) {
    const int band = cell / kSectors, sector = cell % kSectors;
    if (!seen.FarFromSeen(band, sector)) continue;
    for (int i = 0; i < kSamplesASide * kSamplesASide; ++i) {
      const double b = (i / kSamplesASide + 0.5) / kSamplesASide, s = (i % kSamplesASide + 0.5) / kSamplesASide;
      AddPoint(*log_radius, middle, DirectionAt(band + b, sector + s), &guessed);
    }
  }
  return guessed;
}

}  // namespace drupe::dense
