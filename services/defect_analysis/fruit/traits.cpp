#include "defect_analysis/fruit/traits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace drupe {
namespace {

constexpr int kExtentCells = 48;
constexpr int kAzimuths = 36;
constexpr int kColourCells = 24;
constexpr int kReliefCells = 40;  // of the relief that the closed surface is too smooth for: about 0.7 mm on a plum
constexpr std::size_t kReliefPoints = 400'000;  // that it is taken from: some 40 a cell

std::vector<Eigen::Vector3d> SkinPoints(const FruitSurface& surface) {
  const CubeMap map(kExtentCells);
  std::vector<Eigen::Vector3d> points;
  for (int cell = 0; cell < map.size(); ++cell) points.push_back(surface.PointAt(map.DirectionOf(cell)));
  return points;
}

double Extent(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& direction) {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (const Eigen::Vector3d& x : points) {
    low = std::min(low, direction.dot(x));
    high = std::max(high, direction.dot(x));
  }
  return high - low;
}

// What the points' relief adds to the volume of the closed surface: a suture, a hollow and pits are narrower than that
// can follow, and it takes what lies below it for outliers. Where nothing was seen it stands as it is.
double ReliefVolume(const FruitCloud& cloud) {
  const CubeMap map(kReliefCells);
  std::vector<Eigen::Vector2d> sums(map.size(), Eigen::Vector2d::Zero());
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kReliefPoints);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    const Eigen::Vector3f& offset = cloud.offsets[i];
    const double height = offset.norm() - cloud.surface.RadiusAt(offset);
    sums[map.CellOf(offset)] += Eigen::Vector2d(height, 1);
  }
  double volume = 0;
  for (int cell = 0; cell < map.size(); ++cell) {
    if (sums[cell].y() == 0) continue;
    const double radius = cloud.surface.RadiusAt(map.DirectionOf(cell).cast<float>());
    const double relief = radius + sums[cell].x() / sums[cell].y();
    volume += map.SolidAngle(cell) * (relief * relief * relief - radius * radius * radius) / 3;
  }
  return volume;
}

// The mean over cells of directions, so that densely sampled places do not count more than others.
Eigen::Vector3d MeanLab(const FruitCloud& cloud) {
  const CubeMap map(kColourCells);
  std::vector<Eigen::Vector4d> sums(map.size(), Eigen::Vector4d::Zero());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d lab = cloud.lab[i].cast<double>();
    sums[map.CellOf(cloud.offsets[i])] += Eigen::Vector4d(lab[0], lab[1], lab[2], 1);
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  int seen = 0;
  for (const Eigen::Vector4d& sum : sums) {
    if (sum[3] == 0) continue;
    mean += sum.head<3>() / sum[3];
    ++seen;
  }
  return seen > 0 ? Eigen::Vector3d(mean / seen) : mean;
}

}  // namespace

Fruit MeasureTraits(const FruitCloud& cloud) {
  const FruitSurface& surface = cloud.surface;
  const std::vector<Eigen::Vector3d> points = SkinPoints(surface);
  const Eigen::Vector3d across = cloud.up.unitOrthogonal();
  Fruit fruit;
  fruit.centre_mm = surface.centre();
  fruit.volume_mm3 = surface.Volume() + ReliefVolume(cloud);
  fruit.surface_area_mm2 = surface.Area();
  fruit.polar_diameter_mm = Extent(points, cloud.up);
  for (int k = 0; k < kAzimuths; ++k) {
    const Eigen::AngleAxisd turn(std::numbers::pi * k / kAzimuths, cloud.up);
    fruit.equatorial_diameter_mm += Extent(points, turn * across) / kAzimuths;
  }
  fruit.sphericity = std::cbrt(36 * std::numbers::pi * fruit.volume_mm3 * fruit.volume_mm3) / fruit.surface_area_mm2;
  fruit.mean_lab = MeanLab(cloud);
  fruit.observed_surface_pct = 100 * cloud.observed_share;
  return fruit;
}

}  // namespace drupe
