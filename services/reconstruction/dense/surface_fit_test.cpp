#include "reconstruction/dense/surface_fit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace drupe::dense {
namespace {

constexpr int kSide = 31, kMiddle = 15;
constexpr float kUnit = 0.01f;

/// A curved sheet, 1/z over the pixels.
float Sheet(float u, float v) {
  return 0.02f + 1e-4f * u - 5e-5f * v + 2e-5f * u * u + 1e-5f * u * v + 4e-5f * v * v;
}

/// Planes as a refiner fits them over windows of window_px: the sheet's mean over the window, and its slope.
PatchMap PlanesOverSheet(int window_px) {
  PatchMap map(0, 1, kSide, kSide, kUnit);
  const auto mean_square = static_cast<float>(window_px * window_px - 1) / 12;
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const auto u = static_cast<float>(col - kMiddle), v = static_cast<float>(row - kMiddle);
      PatchCell& cell = map.At(col, row);
      cell.w = Sheet(u, v) + 6e-5f * mean_square;
      cell.wu = 1e-4f + 4e-5f * u + 1e-5f * v;
      cell.wv = -5e-5f + 1e-5f * u + 8e-5f * v;
      cell.ncc = 0.9f;
      cell.sigma = 0.1f;
      cell.views = 3;
    }
  }
  return map;
}

SurfaceFitSettings Settings(int window_px) {
  SurfaceFitSettings settings;
  settings.radius = 5;
  settings.window_px = static_cast<float>(window_px);
  return settings;
}

TEST(FitSurface, FindsTheCurvedSurfaceThatThePlanesWereFittedTo) {
  for (const int window_px : {5, 7, 11}) {
    const PatchMap fitted = FitSurface(PlanesOverSheet(window_px), Settings(window_px));
    const PatchCell& cell = fitted.At(kMiddle, kMiddle);
    EXPECT_NEAR(cell.w / kUnit, Sheet(0, 0) / kUnit, 2e-3) << window_px;
    EXPECT_NEAR(cell.wu / kUnit, 1e-4 / kUnit, 1e-3);
    EXPECT_NEAR(cell.bend, 6e-5, 2e-6);
    EXPECT_NEAR(PlaneBias(cell, 7), 6e-5 * 4, 1e-5);
  }
}

TEST(FitSurface, RemovesAPatchThatItsNeighboursDisagreeWith) {
  PatchMap map = PlanesOverSheet(7);
  map.At(kMiddle, kMiddle).w += 0.6f * kUnit;  // 0.6 pixels of parallax off
  const PatchMap fitted = FitSurface(map, Settings(7));
  EXPECT_FALSE(fitted.At(kMiddle, kMiddle).Filled());
  EXPECT_TRUE(fitted.At(kMiddle + 1, kMiddle).Filled());
  EXPECT_NEAR(fitted.At(kMiddle + 1, kMiddle).w / kUnit, Sheet(1, 0) / kUnit, 5e-3);  // nor does it pull them along
}

TEST(FitSurface, RemovesPatchesWithoutNeighbours) {
  PatchMap map = PlanesOverSheet(7);
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      if (std::abs(col - kMiddle) > 1 || std::abs(row - kMiddle) > 1) map.At(col, row) = PatchCell();
    }
  }
  const PatchMap fitted = FitSurface(map, Settings(7));
  for (const PatchCell& cell : fitted.cells) EXPECT_FALSE(cell.Filled());
}

TEST(FitSurface, DoesNotMixTwoSheets) {
  PatchMap map = PlanesOverSheet(7);
  for (int row = 0; row < kSide; ++row) {
    for (int col = kMiddle + 1; col < kSide; ++col) map.At(col, row).w += 8 * kUnit;  // far behind the other half
  }
  const PatchMap fitted = FitSurface(map, Settings(7));
  EXPECT_NEAR(fitted.At(kMiddle, kMiddle).w / kUnit, Sheet(0, 0) / kUnit, 0.02);
  EXPECT_NEAR(fitted.At(kMiddle + 1, kMiddle).w / kUnit, Sheet(1, 0) / kUnit + 8, 0.02);
}

}  // namespace
}  // namespace drupe::dense
