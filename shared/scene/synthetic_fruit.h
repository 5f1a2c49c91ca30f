#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "scene/point_cloud.h"

namespace drupe {

/// A made-up plum for tests: an ellipsoid of revolution with round spots of known area, sampled evenly over the part
/// that cameras above the board see, with mottled and shaded skin, point noise, and a needle and a board below it.
struct SyntheticFruit {
  struct Spot {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< from the centre, unit length
    double radius_mm = 1;                                  ///< along the skin
    Eigen::Vector3d srgb{105, 106, 64};
  };

  Eigen::Vector3d centre{0.5, -0.4, 34};
  double equatorial_mm = 18;  ///< half axis
  double polar_mm = 18;       ///< half axis
  std::vector<Spot> spots;
  double soft_mm = 0.15;   ///< half width of a spot's edge
  double noise_mm = 0.02;  ///< of the points, along the radius
  double lowest = -0.8;    ///< z of the lowest direction that is seen
  int points = 60000;

  /// Adds its points to `cloud`.
  void AddTo(PointCloud& cloud, std::uint64_t seed = 1) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const int turns = points;
    for (int k = 0; k < turns; ++k) {
      // A spherical Fibonacci lattice, jittered, so that density is even.
      const double z = 1 - (2.0 * k + 1) / turns;
      if (z < lowest) continue;
      const double azimuth = 2 * std::numbers::pi * std::numbers::phi * k;
      const double ring = std::sqrt(1 - z * z);
      Eigen::Vector3d d(ring * std::cos(azimuth), ring * std::sin(azimuth), z);
      d = (d + 0.3 / std::sqrt(turns) * Eigen::Vector3d(normal(random), normal(random), normal(random))).normalized();
      Add(centre + (RadiusAt(d) + noise_mm * normal(random)) * d, ColourAt(d, normal(random)), cloud);
    }
  }

  double RadiusAt(const Eigen::Vector3d& d) const {
    const double across = (d.x() * d.x() + d.y() * d.y()) / (equatorial_mm * equatorial_mm);
    return 1 / std::sqrt(across + d.z() * d.z() / (polar_mm * polar_mm));
  }
  double Volume() const { return 4 * std::numbers::pi / 3 * equatorial_mm * equatorial_mm * polar_mm; }
  /// Exact on a sphere: a cap of the arc `radius_mm`.
  double SpotArea(const Spot& spot) const {
    return 2 * std::numbers::pi * equatorial_mm * equatorial_mm * (1 - std::cos(spot.radius_mm / equatorial_mm));
  }

  static void AddBoardAndNeedle(const Eigen::Vector3d& under, PointCloud& cloud) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-50, 50);
    for (int k = 0; k < 20000; ++k) {
      const double shade = k % 2 == 0 ? 30 : 235;
      Add({uniform(random), uniform(random), 0.002 * uniform(random)}, {shade, shade, shade}, cloud);
    }
    for (int k = 0; k < 3000; ++k) {
      const double angle = uniform(random);
      const double height = (under.z() - 16) * (uniform(random) + 50) / 100;
      Add({under.x() + 0.8 * std::cos(angle), under.y() + 0.8 * std::sin(angle), height}, {200, 200, 200}, cloud);
    }
  }

 private:
  static void Add(const Eigen::Vector3d& x, const Eigen::Vector3d& srgb, PointCloud& cloud) {
    cloud.positions.push_back(x.cast<float>());
    cloud.colours.push_back(srgb.array().round().cwiseMax(0.0).cwiseMin(255.0).cast<std::uint8_t>());
  }

  Eigen::Vector3d ColourAt(const Eigen::Vector3d& d, double noise) const {
    const double mottle = std::sin(5 * d.x() + 2) * std::cos(4 * d.y() - 1) * std::sin(3 * d.z());
    Eigen::Vector3d colour(140 + 14 * mottle, 160 + 6 * mottle, 70 + 4 * mottle);
    for (const Spot& spot : spots) {
      const double distance = equatorial_mm * std::acos(std::clamp(d.dot(spot.direction), -1.0, 1.0));
      const double t = std::clamp(0.5 + (spot.radius_mm - distance) / (2 * soft_mm), 0.0, 1.0);
      // Mixed in linear light, as a lens does.
      for (int c = 0; c < 3; ++c) {
        colour[c] =
            255 * std::pow((1 - t) * std::pow(colour[c] / 255, 2.2) + t * std::pow(spot.srgb[c] / 255, 2.2), 1 / 2.2);
      }
    }
    return (0.75 + 0.25 * d.z()) * colour + Eigen::Vector3d::Constant(1.5 * noise);
  }
};

}  // namespace drupe
