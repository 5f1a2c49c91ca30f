#include "defect_analysis/defects/separate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "defect_analysis/defects/colour_layers.h"
#include "defect_analysis/defects/depth.h"
#include "defect_analysis/defects/local_halfway.h"
#include "defect_analysis/defects/test_shapes.h"

namespace drupe {
namespace {

using std::numbers::pi;

FruitSurface Ball() {
  return FruitSurface(Eigen::Vector3d::Zero(), CubeTable<float>::Of(16, [](const Eigen::Vector3d&) { return 18.0f; }));
}

// How far inside a disc, from 0 to 1 over an edge 0.2 mm wide.
float Disc(const Eigen::Vector2d& p, const Eigen::Vector2d& middle, double radius) {
  return static_cast<float>(std::clamp(0.5 + (radius - (p - middle).norm()) / 0.2, 0.0, 1.0));
}

// A field of 6 x 6 mm about the middle, `level(place)` and `change(place)` at its nodes.
template <typename Level, typename Change>
TransitionField FieldOf(const FruitSurface& surface, const Level& level, const Change& change) {
  TransitionField field{.chart = SkinChart(surface, Eigen::Vector3d::UnitX())};
  field.width = field.height = 200;
  field.step = 0.03;
  field.origin = Eigen::Vector2d(-3, -3);
  field.blur = 0.06;
  field.spacing = 0.09;
  field.noise = 0.05;
  field.healthy_linear = Eigen::Vector3d(0.25, 0.30, 0.05);
  field.change_noise = Eigen::Vector3f::Constant(0.05f);
  for (int row = 0; row < field.height; ++row) {
    for (int column = 0; column < field.width; ++column) {
      const Eigen::Vector2d p = field.FlatOf(column, row);
      field.level.push_back(level(p));
      field.change.push_back(change(p));
      field.inside.push_back(field.level.back() > 0.3f ? 1 : 0);
    }
  }
  field.full_level = field.level;
  field.defect_linear = Eigen::Vector3d(0.1, 0.1, 0.04);
  return field;
}

TEST(SeparateDefects, TellsABrownSpotFromABlackStripItTouches) {
  const FruitSurface surface = Ball();
  const Eigen::Vector3f brown(-0.40f, -0.57f, 0.0f), black(-0.80f, -0.83f, -0.70f);
  const auto strip = [](const Eigen::Vector2d& p) {
    return static_cast<float>(std::clamp(0.5 + (0.3 - std::abs(p.y())) / 0.2, 0.0, 1.0)) *
           (std::abs(p.x()) < 2.4 ? 1.0f : 0.0f);
  };
  const auto spot = [](const Eigen::Vector2d& p) { return Disc(p, {0.3, 0.9}, 0.7); };
  const TransitionField field = FieldOf(
      surface, [&](const Eigen::Vector2d& p) { return std::max(strip(p), spot(p)); },
      [&](const Eigen::Vector2d& p) {
        return Eigen::Vector3f(strip(p) * black + (1 - strip(p)) * spot(p) * brown);  // the strip lies on top
      });
  const Outlines found = SeparateDefects(field, 9, {});
  ASSERT_EQ(found.outlines.size(), 2u);
  const Outline& first = found.outlines[0];
  const Outline& second = found.outlines[1];
  EXPECT_NEAR(SignedArea(first.polygon), 4.8 * 0.6, 0.1);
  EXPECT_NEAR(SignedArea(second.polygon), pi * 0.49, 0.05);
  EXPECT_FALSE(first.completed);
  EXPECT_TRUE(second.completed);
}

// Where share(place) is over 0.3 the patch is too.
template <typename Share>
void TakeInside(const Share& share, TransitionField& field) {
  for (int row = 0; row < field.height; ++row) {
    for (int column = 0; column < field.width; ++column) {
      if (share(field.FlatOf(column, row)) > 0.3f)
        field.inside[static_cast<std::size_t>(row) * field.width + column] = 1;
    }
  }
}

// The spot's colour is sixteen times as far from the skin's as the strip's, which is as light as the skin.
TEST(SeparateDefects, TellsAStripOfAnotherHueFromABleachedSpotItTouches) {
  const FruitSurface surface = Ball();
  const Eigen::Vector3f bleached(1.2f, 0.8f, 9.0f), hue(-0.1f, -0.45f, -0.3f);
  const auto strip = [](const Eigen::Vector2d& p) {
    return static_cast<float>(std::clamp(0.5 + (0.3 - std::abs(p.y())) / 0.2, 0.0, 1.0)) *
           (std::abs(p.x()) < 2.4 ? 1.0f : 0.0f);
  };
  const auto spot = [](const Eigen::Vector2d& p) { return Disc(p, {0.3, 1.1}, 0.9); };
  TransitionField field = FieldOf(
      surface, [&](const Eigen::Vector2d& p) { return (1 - strip(p)) * spot(p); },
      [&](const Eigen::Vector2d& p) { return Eigen::Vector3f(strip(p) * hue + (1 - strip(p)) * spot(p) * bleached); });
  TakeInside(strip, field);
  const Outlines found = SeparateDefects(field, 9, {});
  ASSERT_EQ(found.outlines.size(), 2u);
  EXPECT_NEAR(SignedArea(found.outlines[0].polygon), pi * 0.81, 0.15);
  EXPECT_NEAR(SignedArea(found.outlines[1].polygon), 4.8 * 0.6, 0.15);
}

// On brown skin: the pale one's colour is that of gloss but for 7 Lab units.
TEST(SeparateDefects, TellsADarkSpotFromAPaleOneThatIsNearlyAsGloss) {
  const FruitSurface surface = Ball();
  const Eigen::Vector3f pale(0.77f, 1.71f, 4.28f), dark(-0.61f, -0.57f, -0.42f);
  const auto upper = [](const Eigen::Vector2d& p) { return Disc(p, {0, -1.0}, 1.4); };
  const auto lower = [](const Eigen::Vector2d& p) { return Disc(p, {0, 1.4}, 1.2); };
  TransitionField field = FieldOf(
      surface, [&](const Eigen::Vector2d& p) { return upper(p); },
      [&](const Eigen::Vector2d& p) {
        return Eigen::Vector3f(upper(p) * pale + (1 - upper(p)) * lower(p) * dark);  // the pale one lies on top
      });
  field.healthy_linear = Eigen::Vector3d(0.206, 0.110, 0.043);
  field.defect_linear = Eigen::Vector3d(0.365, 0.298, 0.227);
  TakeInside(lower, field);
  const Outlines found = SeparateDefects(field, 9, {});
  ASSERT_EQ(found.outlines.size(), 2u);
  EXPECT_NEAR(SignedArea(found.outlines[0].polygon), pi * 1.96, 0.1);
  EXPECT_NEAR(SignedArea(found.outlines[1].polygon), pi * 1.44, 0.1);
}

// On brown skin: the crack differs from it by 8.2 Lab units, less than what stands alone must; shade as dark does too.
TEST(SeparateDefects, TellsAFaintCrackFromASpotItTouchesAndLeavesShade) {
  const FruitSurface surface = Ball();
  const Eigen::Vector3f red(0.947f, -0.528f, -0.278f), crack(-0.388f, -0.36f, -0.17f), shade(-0.36f, -0.36f, -0.36f);
  const auto strip = [](const Eigen::Vector2d& p) {
    return static_cast<float>(std::clamp(0.5 + (0.25 - std::abs(p.y())) / 0.2, 0.0, 1.0)) *
           (std::abs(p.x()) < 2.4 ? 1.0f : 0.0f);
  };
  const auto spot = [](const Eigen::Vector2d& p) { return Disc(p, {0.3, 1.1}, 1.1); };
  for (const Eigen::Vector3f& dark : {crack, shade}) {
    TransitionField field = FieldOf(
        surface, [&](const Eigen::Vector2d& p) { return (1 - strip(p)) * spot(p); },
        [&](const Eigen::Vector2d& p) { return Eigen::Vector3f(strip(p) * dark + (1 - strip(p)) * spot(p) * red); });
    field.healthy_linear = Eigen::Vector3d(0.170, 0.089, 0.036);
    field.defect_linear = Eigen::Vector3d(0.331, 0.042, 0.026);
    TakeInside(strip, field);
    EXPECT_EQ(SeparateDefects(field, 9, {}).outlines.size(), dark == crack ? 2u : 1u);
    DefectOptions clear_ones;
    clear_ones.segmentation.faint_share = 1;
    EXPECT_EQ(SeparateDefects(field, 9, clear_ones).outlines.size(), 1u);
  }
}

// Half as wide as the scar and as faint as the crack above.
TEST(SeparateDefects, LeavesAScarWithALongStreakOfAnotherHueWhole) {
  const FruitSurface surface = Ball();
  const Eigen::Vector3f red(0.947f, -0.528f, -0.278f), streak(-0.388f, -0.36f, -0.17f);
  const auto along = [](const Eigen::Vector2d& p) { return std::abs(p.x()) < 2.4 ? 1.0f : 0.0f; };
  const auto strip = [&](const Eigen::Vector2d& p, double middle, double half_width) {
    return static_cast<float>(std::clamp(0.5 + (half_width - std::abs(p.y() - middle)) / 0.2, 0.0, 1.0)) * along(p);
  };
  TransitionField field = FieldOf(
      surface, [&](const Eigen::Vector2d& p) { return strip(p, 0.6, 0.5); },
      [&](const Eigen::Vector2d& p) {
        return Eigen::Vector3f(strip(p, -0.2, 0.3) * streak + (1 - strip(p, -0.2, 0.3)) * strip(p, 0.6, 0.5) * red);
      });
  field.healthy_linear = Eigen::Vector3d(0.170, 0.089, 0.036);
  field.defect_linear = Eigen::Vector3d(0.331, 0.042, 0.026);
  TakeInside([&](const Eigen::Vector2d& p) { return strip(p, -0.2, 0.3); }, field);
  EXPECT_EQ(SeparateDefects(field, 9, {}).outlines.size(), 1u);
}

TEST(SeparateDefects, TellsAFaintSpotFromAStrongOneOfItsHueThatItTouches) {
  const FruitSurface surface = Ball();
  const Eigen::Vector3f brown(-0.60f, -0.70f, -0.30f);
  const auto strong = [](const Eigen::Vector2d& p) { return Disc(p, {0, -0.9}, 1.3); };
  const auto change = [&](const Eigen::Vector2d& p) {
    const float faint = Disc(p, {0, 1.2}, 1.1);
    return strong(p) + (1 - strong(p)) * 0.5f * faint;
  };
  const TransitionField field =
      FieldOf(surface, change, [&](const Eigen::Vector2d& p) { return Eigen::Vector3f(change(p) * brown); });
  const Outlines found = SeparateDefects(field, 9, {});
  ASSERT_EQ(found.outlines.size(), 2u);
  EXPECT_NEAR(SignedArea(found.outlines[0].polygon), pi * 1.69, 0.1);
  EXPECT_NEAR(SignedArea(found.outlines[1].polygon), pi * 1.21, 0.1);
}

// A crack that leaves a shadow, or goes over to skin of another hue, half-way.
TEST(SeparateDefects, LeavesAStripWhoseHueChangesOnItsWayWhole) {
  const FruitSurface surface = Ball();
  const Eigen::Vector3f one(-0.76f, -0.80f, -0.60f), other(-0.55f, -0.68f, 0.10f);
  const auto strip = [](const Eigen::Vector2d& p) {
    return static_cast<float>(std::clamp(0.5 + (0.25 - std::abs(p.y())) / 0.2, 0.0, 1.0)) *
           (std::abs(p.x()) < 2.4 ? 1.0f : 0.0f);
  };
  const auto turn = [](const Eigen::Vector2d& p) { return static_cast<float>(std::clamp(0.5 + p.x(), 0.0, 1.0)); };
  const TransitionField field = FieldOf(surface, strip, [&](const Eigen::Vector2d& p) {
    return Eigen::Vector3f(strip(p) * ((1 - turn(p)) * one + turn(p) * other));
  });
  const Outlines found = SeparateDefects(field, 9, {});
  ASSERT_EQ(found.outlines.size(), 1u);
  EXPECT_NEAR(SignedArea(found.outlines[0].polygon), 4.8 * 0.5, 0.1);
}

TEST(SeparateDefects, LeavesASpotWithADarkMiddleWhole) {
  const FruitSurface surface = Ball();
  const auto change = [](const Eigen::Vector2d& p) {
    const float spot = Disc(p, {0, 0}, 1.5), middle = Disc(p, {0.1, 0}, 0.7);
    return Eigen::Vector3f(
        spot * ((1 - middle) * Eigen::Vector3f(-0.4f, -0.57f, 0) + middle * Eigen::Vector3f(-0.8f, -0.83f, -0.7f)));
  };
  const auto level = [](const Eigen::Vector2d& p) { return Disc(p, {0, 0}, 1.5); };
  const Outlines found = SeparateDefects(FieldOf(surface, level, change), 9, {});
  ASSERT_EQ(found.outlines.size(), 1u);
  EXPECT_NEAR(SignedArea(found.outlines[0].polygon), pi * 2.25, 0.05);
}

// A broad brown patch with black blots along its rim, as decay has.
TEST(SeparateDefects, LeavesAPatchWithDarkBlotsOnItsRimWhole) {
  const FruitSurface surface = Ball();
  const auto patch = [](const Eigen::Vector2d& p) { return Disc(p, {0, 0}, 2.2); };
  const auto blots = [](const Eigen::Vector2d& p) {
    return std::max(Disc(p, {1.75, 0.2}, 0.55), Disc(p, {-0.6, 1.7}, 0.5));
  };
  const auto change = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector3f(blots(p) * Eigen::Vector3f(-0.8f, -0.83f, -0.7f) +
                           (1 - blots(p)) * patch(p) * Eigen::Vector3f(-0.4f, -0.57f, 0));
  };
  const auto level = [&](const Eigen::Vector2d& p) { return std::max(patch(p), blots(p)); };
  const Outlines found = SeparateDefects(FieldOf(surface, level, change), 9, {});
  ASSERT_EQ(found.outlines.size(), 1u);
  EXPECT_GT(SignedArea(found.outlines[0].polygon), pi * 2.2 * 2.2 - 0.1);
}

TEST(CommonArea, OfTwoDiscs) {
  const Polygon a = ArcOf({0, 0}, 1, 0, 2 * pi, 200), b = ArcOf({1, 0}, 1, 0, 2 * pi, 200);
  EXPECT_NEAR(CommonArea(a, b), 2 * pi / 3 - std::sqrt(3.0) / 2, 0.02);
  EXPECT_NEAR(CommonArea(a, ArcOf({0.2, 0}, 0.5, 0, 2 * pi, 200)), pi / 4, 0.02);
  EXPECT_EQ(CommonArea(a, ArcOf({3, 0}, 1, 0, 2 * pi, 200)), 0);
}

// Skin that is shaded to 0.4 of the defect's level on one side of a disc with a soft edge.
TEST(FollowLocalHalfway, IsNotMovedByShadeBesideTheDefect) {
  const FruitSurface surface = Ball();
  const auto level = [](const Eigen::Vector2d& p) {
    const auto disc = static_cast<float>(std::clamp(0.5 + (1 - p.norm()) / 0.4, 0.0, 1.0));
    const float shade = p.x() > 0 ? 0.4f : 0.0f;
    return disc + (1 - disc) * shade;
  };
  const TransitionField field = FieldOf(surface, level, [](const Eigen::Vector2d&) { return Eigen::Vector3f::Zero(); });
  const Polygon outline = TraceBoundaries(field, 0.5, 0.3).at(0);
  EXPECT_GT(SignedArea(outline), 1.06 * pi);
  EXPECT_NEAR(SignedArea(FollowLocalHalfway(field, outline, 0.5)) / pi, 1, 0.03);
}

// A ball with a hollow 0.2 mm deep and 2 mm in radius.
TEST(MeasureDepth, OfAHollow) {
  FruitCloud fruit;
  fruit.surface = Ball();
  fruit.observed_share = 1;
  constexpr int kPoints = 120000;
  for (int k = 0; k < kPoints; ++k) {
    const double x = 1 - (2.0 * k + 1) / kPoints, azimuth = 2 * pi * std::numbers::phi * k;
    const double ring = std::sqrt(1 - x * x), away = 18 * std::acos(x);
    const double radius = 18 - 0.2 * std::clamp((2 - away) / 0.3, 0.0, 1.0);
    const Eigen::Vector3d direction(x, ring * std::cos(azimuth), ring * std::sin(azimuth));
    fruit.offsets.push_back((radius * direction).cast<float>());
    fruit.colours.push_back(Rgb8(100, 150, 50));
    fruit.lab.push_back(LabFromSrgb(fruit.colours.back()));
  }
  const SkinMap map(fruit);
  const SkinChart chart(fruit.surface, Eigen::Vector3d::UnitX());
  const DefectDepth depth = MeasureDepth(fruit, map, chart, ArcOf({0, 0}, 2, 0, 2 * pi, 100));
  EXPECT_NEAR(depth.mm, 0.2, 0.01);
  EXPECT_LT(depth.uncertainty_mm, 0.01);
  const DefectDepth level =
      MeasureDepth(fruit, map, SkinChart(fruit.surface, Eigen::Vector3d::UnitZ()), ArcOf({0, 0}, 2, 0, 2 * pi, 100));
  EXPECT_NEAR(level.mm, 0, 0.003);
}

}  // namespace
}  // namespace drupe
