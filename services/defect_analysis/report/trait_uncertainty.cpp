#include "defect_analysis/report/trait_uncertainty.h"

#include <algorithm>
#include <cmath>

namespace drupe {
namespace {

constexpr double kSharedNoise = 0.2;     // of the points' scatter: error of a radius as a whole
constexpr double kLeastRadius = 0.0002;  // relative: error of a radius as a whole
constexpr double kUnseenVolume = 0.015;  // of the unseen part
constexpr double kUnseenArea = 0.008;
constexpr double kUnseenPolar = 0.03;  // of the polar diameter, times the unseen share

Eigen::Vector3d LabSpread(const FruitCloud& cloud) {
  if (cloud.size() == 0) return Eigen::Vector3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& lab : cloud.lab) {
    sum += lab.cast<double>();
    squares += lab.cast<double>().cwiseAbs2();
  }
  const double count = static_cast<double>(cloud.size());
  return (squares / count - (sum / count).cwiseAbs2()).cwiseMax(0).cwiseSqrt();
}

}  // namespace

void AddTraitUncertainties(const FruitCloud& cloud, double scale_sigma, Fruit& fruit) {
  const double radius = std::max(1e-9, cloud.surface.MeanRadius());
  const double of_radius = std::max(kLeastRadius, kSharedNoise * cloud.noise_mm / radius);
  const double of_length = std::hypot(of_radius, scale_sigma);
  const double unseen = std::clamp(1 - cloud.observed_share, 0.0, 1.0);
  fruit.volume_uncertainty_mm3 = fruit.volume_mm3 * std::hypot(3 * of_length, kUnseenVolume * unseen);
  fruit.surface_area_uncertainty_mm2 = fruit.surface_area_mm2 * std::hypot(2 * of_length, kUnseenArea * unseen);
  fruit.equatorial_uncertainty_mm = fruit.equatorial_diameter_mm * of_length;
  fruit.polar_uncertainty_mm = fruit.polar_diameter_mm * std::hypot(of_length, kUnseenPolar * unseen);
  fruit.lab_spread = LabSpread(cloud);
}

}  // namespace drupe
