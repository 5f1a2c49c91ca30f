#include "image/colour.h"

#include <gtest/gtest.h>

#include <cmath>

namespace drupe {
namespace {

// Lab in double precision, straight from the definition.
Eigen::Vector3d ReferenceLab(const Rgb8& colour) {
  const auto linear = [](int value) {
    const double v = value / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  };
  const auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  const double r = linear(colour[0]), g = linear(colour[1]), b = linear(colour[2]);
  const double x = f((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const double y = f(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = f((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

TEST(Colour, LabAgreesWithItsDefinition) {
  double worst = 0;
  for (int r = 0; r < 256; r += 5) {
    for (int g = 0; g < 256; g += 5) {
      for (int b = 0; b < 256; b += 5) {
        const Rgb8 colour(static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g), static_cast<std::uint8_t>(b));
        worst = std::max(worst, (LabFromSrgb(colour).cast<double>() - ReferenceLab(colour)).cwiseAbs().maxCoeff());
      }
    }
  }
  EXPECT_LT(worst, 0.01);
}

TEST(Colour, WhiteAndBlack) {
  EXPECT_LT((LabFromSrgb(Rgb8(255, 255, 255)) - Eigen::Vector3f(100, 0, 0)).norm(), 0.02);
  EXPECT_LT(LabFromSrgb(Rgb8(0, 0, 0)).norm(), 0.01);
}

}  // namespace
}  // namespace drupe
