#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "defect_analysis/defects/find_defects.h"
#include "image/colour.h"

namespace drupe {
namespace {

using std::numbers::pi;
constexpr double kRadius = 10;  // mm, of the fruit
constexpr double kSpot = 0.9;   // mm, of the spots
constexpr int kSkinPoints = 56'000;

struct Spot {
  Eigen::Vector3d axis;
  Eigen::Vector3d linear;
};

double SrgbOf(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

// A ball lit from above, with a highlight that was not quite removed, and spots with an edge 0.2 mm wide.
FruitCloud Ball(const Eigen::Vector3d& skin, const std::vector<Spot>& spots) {
  FruitCloud fruit;
  fruit.surface =
      FruitSurface(Eigen::Vector3d::Zero(),
                   CubeTable<float>::Of(16, [](const Eigen::Vector3d&) { return static_cast<float>(kRadius); }));
  fruit.observed_share = 1;
  const Eigen::Vector3d lamp = Eigen::Vector3d(0.2, -1, 0.6).normalized();
  std::uint32_t state = 7;
  const auto noise = [&state] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) * 0x1p-24 - 0.5;
  };
  for (int k = 0; k < kSkinPoints; ++k) {
    const double z = 1 - (2.0 * k + 1) / kSkinPoints, ring = std::sqrt(1 - z * z),
                 azimuth = 2 * pi * std::numbers::phi * k;
    const Eigen::Vector3d d(ring * std::cos(azimuth), ring * std::sin(azimuth), z);
    Eigen::Vector3d linear = skin;
    for (const Spot& spot : spots) {
      const double inside = kSpot - kRadius * std::acos(std::clamp(d.dot(spot.axis), -1.0, 1.0));
      const double share = std::clamp(0.5 + inside / 0.2, 0.0, 1.0);
      linear = (1 - share) * linear + share * spot.linear;
    }
    linear *= 0.85 + 0.15 * z;
    linear.array() += 0.08 * std::exp(-(1 - d.dot(lamp)) * 2 / (0.2 * 0.2));
    Rgb8 colour;
    for (int c = 0; c < 3; ++c) {
      const double value = 255 * SrgbOf(std::min(1.0, linear[c])) + 4 * noise() + 0.5;
      colour[c] = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
    }
    fruit.offsets.push_back((kRadius * d).cast<float>());
    fruit.colours.push_back(colour);
    fruit.lab.push_back(LabFromSrgb(colour));
  }
  return fruit;
}

Eigen::Vector3d LinearOf(int r, int g, int b) {
  return LinearFromSrgb(Rgb8(static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g), static_cast<std::uint8_t>(b)))
      .cast<double>();
}

struct Kind {
  const char* name;
  Eigen::Vector3d skin;
  Eigen::Vector3d hue;  // of a spot that differs in hue only
};

std::vector<Kind> Kinds() {
  return {{"green", LinearOf(134, 154, 66), LinearOf(190, 60, 50)},
          {"yellow", LinearOf(200, 168, 66), LinearOf(60, 150, 60)},
          {"red", LinearOf(166, 52, 48), LinearOf(60, 150, 60)},
          {"purple", LinearOf(92, 56, 88), LinearOf(200, 150, 20)},
          {"brown", LinearOf(124, 92, 58), LinearOf(60, 150, 60)},
          {"grey", LinearOf(138, 136, 130), LinearOf(190, 60, 50)},
          {"pale", LinearOf(206, 200, 150), LinearOf(190, 60, 50)}};
}

Eigen::Vector3d AsLight(const Eigen::Vector3d& hue, const Eigen::Vector3d& skin) {
  const Eigen::Vector3d luminance(0.2127, 0.7152, 0.0722);
  return hue * std::min(skin.dot(luminance) / hue.dot(luminance), 0.95 / hue.maxCoeff());
}

TEST(FindDefects, OfAnyToneOnSkinOfAnyColour) {
  for (const Kind& kind : Kinds()) {
    const Eigen::Vector3d white(0.85, 0.85, 0.85);
    const std::vector<Spot> spots = {{Eigen::Vector3d(1, 0, 0.2).normalized(), 0.35 * kind.skin},
                                     {Eigen::Vector3d(-1, 0.3, 0).normalized(), 0.4 * kind.skin + 0.6 * white},
                                     {Eigen::Vector3d(0, 1, -0.2).normalized(), AsLight(kind.hue, kind.skin)}};
    const auto defects = FindDefects(Ball(kind.skin, spots), {}, {});
    ASSERT_TRUE(defects.ok());
    EXPECT_EQ(defects->size(), spots.size()) << kind.name;
    for (std::size_t k = 0; k < spots.size(); ++k) {
      const auto found = std::find_if(defects->begin(), defects->end(), [&](const Defect& defect) {
        return (defect.centre_mm - kRadius * spots[k].axis).norm() < 0.3;
      });
      ASSERT_NE(found, defects->end()) << kind.name << " spot " << k;
      const double area = 2 * pi * kRadius * kRadius * (1 - std::cos(kSpot / kRadius));
      EXPECT_NEAR(found->area_mm2 / area, 1, 0.04) << kind.name << " spot " << k;
      EXPECT_EQ(found->defect_class, DefectClass::kRainSpot);
    }
    const auto intact = FindDefects(Ball(kind.skin, {}), {}, {});
    ASSERT_TRUE(intact.ok());
    EXPECT_TRUE(intact->empty()) << kind.name;
  }
}

}  // namespace
}  // namespace drupe
