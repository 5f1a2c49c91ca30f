#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <random>

#include "geometry/cube_table.h"
#include "scene/report.h"

namespace drupe {

/// Random numbers that are the same on every platform (the distributions of <random> are not).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed * 0x9E3779B97F4A7C15ull + 1) {}
  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  int Below(int count) { return static_cast<int>(Uniform(0, count)); }
  bool Chance(double share) { return Uniform(0, 1) < share; }
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(Uniform(1e-300, 1)));
    return radius * std::cos(Uniform(0, 2 * std::numbers::pi));
  }
  Eigen::Vector3d Direction() {
    const double z = Uniform(-1, 1), azimuth = Uniform(0, 2 * std::numbers::pi), ring = std::sqrt(1 - z * z);
    return {ring * std::cos(azimuth), ring * std::sin(azimuth), z};
  }

 private:
  std::mt19937_64 random_;
};

/// A smooth random function of direction: `waves` radians of phase from the middle to the rim, standard deviation 1.
class SmoothNoise {
 public:
  SmoothNoise(Dice& dice, double waves, int cells);
  double At(const Eigen::Vector3d& direction) const { return table_.At(direction.cast<float>()); }

 private:
  CubeTable<float> table_;
};

/// A closed shape on the skin, drawn about one direction, and its colour.
struct SkinShape {
  DefectClass defect_class = DefectClass::kRainSpot;
  Eigen::Vector3d axis, right, down;  ///< right-handed, axis outward
  double radius_mm = 1;               ///< of the circle with its area
  double stretch = 1;                 ///< length over width
  double bend = 0;                    ///< curvature of the long axis, 1/mm
  double lobes[4] = {0, 0, 0, 0};     ///< amplitudes of the outline's waves 2 to 5, relative
  double phases[4] = {0, 0, 0, 0};
  double soft_mm = 0.1;                              ///< half width of the edge
  double depth_mm = 0;                               ///< sunk below the skin
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();  ///< colour in linear light
  double cover = 1;                                  ///< how much of the skin's own colour it hides, 0..1

  /// How far inside the outline a direction lies, mm along the skin at `scale` mm a radian; negative outside.
  double InsideBy(const Eigen::Vector3d& direction, double scale) const;
  /// The outline's point at an angle of its ellipse, mm along `right` and `down` on the skin unrolled about the axis.
  Eigen::Vector2d OutlineAt(double angle) const;
  /// Its colour on skin of that colour, linear light.
  Eigen::Vector3d ColourOn(const Eigen::Vector3d& skin) const { return (1 - cover) * skin + cover * linear; }
  /// The largest distance of the outline from the middle, mm.
  double Reach() const;

 private:
  double EdgeAt(double angle) const;
};

/// A shape of the class with random size, outline and a colour that can be told from `skin` (linear light): darker,
/// paler, or a rain spot as light as the skin in another hue.
SkinShape DrawShape(Dice& dice, DefectClass defect_class, const Eigen::Vector3d& skin, const Eigen::Vector3d& axis);

/// The skin's mean colour of a random kind of fruit, linear light: green, yellow, red, purple, brown, dark, grey or
/// pale.
Eigen::Vector3d DrawSkinColour(Dice& dice);

}  // namespace drupe
