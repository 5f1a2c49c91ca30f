#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "defect_analysis/defects/bridge_gaps.h"
#include "defect_analysis/defects/classify.h"
#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/measure_defect.h"
#include "defect_analysis/defects/plane_fit.h"
#include "defect_analysis/defects/segmentation.h"
#include "defect_analysis/defects/significance.h"

namespace drupe {
namespace {

Polygon Ellipse(double a, double b, int points) {
  Polygon polygon;
  for (int k = 0; k < points; ++k) {
    const double t = 2 * std::numbers::pi * k / points;
    polygon.emplace_back(3 + a * std::cos(t), -1 + b * std::sin(t));
  }
  return polygon;
}

FruitSurface Sphere(float radius) {
  return FruitSurface(Eigen::Vector3d(1, 2, 3),
                      CubeTable<float>::Of(16, [radius](const Eigen::Vector3d&) { return radius; }));
}

TEST(SegmentColours, IntactSkinHasOneClass) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 1.5f);
  std::vector<Eigen::Vector3f> colours;
  for (int k = 0; k < 20000; ++k) colours.emplace_back(noise(random), noise(random), noise(random));
  const std::vector<std::uint8_t> used(colours.size(), 1);
  const Segmentation result = SegmentColours(colours, used, 2, {});
  EXPECT_EQ(result.centres.size(), 1u);
  EXPECT_TRUE(std::all_of(result.class_of.begin(), result.class_of.end(), [](int c) { return c == 0; }));
}

TEST(SegmentColours, TwoKindsOfDefectsGetTheirOwnClasses) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 1);
  const std::vector<Eigen::Vector3f> kinds = {{0, 0, 0}, {-8, 22, -20}, {-20, 40, -30}};
  std::vector<Eigen::Vector3f> colours;
  for (int k = 0; k < 30000; ++k) {
    const int kind = k % 100 < 96 ? 0 : k % 100 < 98 ? 1 : 2;
    colours.push_back(kinds[kind] + Eigen::Vector3f(noise(random), noise(random), noise(random)));
  }
  std::vector<std::uint8_t> used(colours.size(), 1);
  used[98] = 0;  // a colour nobody has seen stays healthy
  const Segmentation result = SegmentColours(colours, used, 1.5, {});
  ASSERT_EQ(result.centres.size(), 3u);
  EXPECT_EQ(result.class_of[0], 0);
  EXPECT_EQ(result.class_of[98], 0);
  EXPECT_NE(result.class_of[96], 0);
  EXPECT_NE(result.class_of[99], 0);
  EXPECT_NE(result.class_of[96], result.class_of[99]);
  EXPECT_LT((result.centres[result.class_of[96]] - kinds[1]).norm(), 1);
  EXPECT_LT(result.davies_bouldin, 0.5);
}

TEST(ClosedSpline, FollowsACircleWithTenControlPoints) {
  const auto spline = ClosedSpline::Fit(Ellipse(1, 1, 200), 10, 3);
  ASSERT_TRUE(spline.ok());
  const Polygon curve = spline->Sample(80);
  ASSERT_EQ(curve.size(), 800u);
  EXPECT_NEAR(SignedArea(curve), std::numbers::pi, 1e-3);
  EXPECT_LT(spline->rms(), 2e-3);
  EXPECT_LT((Centroid(curve) - Eigen::Vector2d(3, -1)).norm(), 1e-3);
}

TEST(ClosedSpline, AreaConvergesWithSamplingDensity) {
  const auto spline = ClosedSpline::Fit(Ellipse(1.6, 1.2, 300), 10, 3);
  ASSERT_TRUE(spline.ok());
  const double fine = SignedArea(spline->Sample(500));
  EXPECT_GT(std::abs(SignedArea(spline->Sample(1)) / fine - 1), 0.02);
  EXPECT_LT(std::abs(SignedArea(spline->Sample(80)) / fine - 1), 1e-4);  // the paper's Table 5
}

TEST(ClosedSpline, TooFewPointsAreRefused) {
  const auto spline = ClosedSpline::Fit(Ellipse(1, 1, 3), 10, 3);
  ASSERT_FALSE(spline.ok());
  EXPECT_EQ(spline.status().code(), "degenerate_contour");
}

TEST(HeronArea, IsThatOfATiltedSquare) {
  const std::vector<Eigen::Vector3d> square = {{0, 0, 0}, {2, 0, 0}, {2, 2, 2}, {0, 2, 2}};
  EXPECT_NEAR(HeronArea(square, Eigen::Vector3d(0, -1, 1).normalized()), 4 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(ClosedLength(square), 4 + 4 * std::sqrt(2.0), 1e-12);
}

// A field with a soft disc of radius 1 mm and, if asked, a hole and a second disc outside the patch.
TransitionField DiscField(const FruitSurface& surface, bool hole, bool stranger) {
  TransitionField field{.chart = SkinChart(surface, Eigen::Vector3d::UnitX())};
  field.width = field.height = 120;
  field.step = 0.05;
  field.origin = Eigen::Vector2d(-2, -2);
  for (int row = 0; row < field.height; ++row) {
    for (int column = 0; column < field.width; ++column) {
      const Eigen::Vector2d p = field.FlatOf(column, row);
      double level = 0.5 + (1 - p.norm()) / 0.4;
      if (hole) level = std::min(level, (p.norm() - 0.3) / 0.1);
      if (stranger) level = std::max(level, 0.5 + (0.6 - (p - Eigen::Vector2d(2.8, 2.8)).norm()) / 0.4);
      field.level.push_back(static_cast<float>(std::clamp(level, 0.0, 1.0)));
      field.inside.push_back(p.norm() < 0.9 ? 1 : 0);
    }
  }
  return field;
}

TEST(TraceBoundaries, FindsTheDiscBetweenTheNodes) {
  const FruitSurface surface = Sphere(18);
  for (const auto& [hole, stranger] : {std::pair{false, false}, {true, false}, {false, true}}) {
    const auto boundaries = TraceBoundaries(DiscField(surface, hole, stranger), 0.5, 0.2);
    ASSERT_EQ(boundaries.size(), 1u);
    EXPECT_NEAR(SignedArea(boundaries[0]), std::numbers::pi, 0.004);
    for (const Eigen::Vector2d& p : boundaries[0]) ASSERT_NEAR(p.norm(), 1, 0.005);
  }
}

TEST(SkinChart, KeepsAreasAndReturns) {
  const FruitSurface surface = Sphere(18);
  const SkinChart chart(surface, Eigen::Vector3d(1, 1, 0.3));
  for (const Eigen::Vector2d& flat : {Eigen::Vector2d(0, 0), {3, -4}, {12, 9}}) {
    EXPECT_LT((chart.FlatFromDirection(chart.DirectionFromFlat(flat)) - flat).norm(), 1e-9);
    EXPECT_NEAR(chart.AreaScale(flat), 1, 1e-5);
  }
}

TEST(FitDefectPlane, IgnoresPointsOffThePlane) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Vector3d normal = Eigen::Vector3d(1, 2, 2) / 3;
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector3d x(uniform(random), uniform(random), uniform(random));
    points.push_back(x - normal * (normal.dot(x) - 5) + normal * (k % 8 == 0 ? 0.5 : 0.002 * uniform(random)));
  }
  PlaneOptions options;
  options.iterations = 50;
  const auto plane = FitDefectPlane(points, normal, 0, options, 1);
  ASSERT_TRUE(plane.ok());
  EXPECT_GT(plane->normal.dot(normal), 0.99999);
  EXPECT_NEAR(plane->offset_mm, 5, 1e-3);
  EXPECT_LT(plane->rms_mm, 0.003);
  EXPECT_NEAR(plane->mean_abs_z_mm, 0.5 / 8, 0.01);
}

TEST(FitDefectPlane, PointsOnALineAreRefused) {
  const std::vector<Eigen::Vector3d> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  EXPECT_EQ(FitDefectPlane(line, Eigen::Vector3d::UnitZ(), 0, {}, 1).status().code(), "degenerate_plane");
}

// A ball of radius 18 mm, green where x < 0 and brown elsewhere, without a band of 2 mm at x = 0 and without a cap
// below.
FruitCloud BallWithGap() {
  FruitCloud fruit;
  fruit.surface = Sphere(18);
  fruit.observed_share = 0.75;
  constexpr int kPoints = 40000;
  for (int k = 0; k < kPoints; ++k) {
    const double z = 1 - (2.0 * k + 1) / kPoints, azimuth = 2 * std::numbers::pi * std::numbers::phi * k;
    const double ring = std::sqrt(1 - z * z);
    const Eigen::Vector3d d(ring * std::cos(azimuth), ring * std::sin(azimuth), z);
    if (std::abs(18 * d.x()) < 1 || z < -0.5) continue;
    fruit.offsets.push_back((18 * d).cast<float>());
    fruit.colours.push_back(d.x() < 0 ? Rgb8(100, 150, 50) : Rgb8(100, 90, 60));
    fruit.lab.push_back(LabFromSrgb(fruit.colours.back()));
  }
  return fruit;
}

TEST(BridgeGaps, FillsNarrowGapsWithTheColoursAtTheirEdges) {
  const FruitCloud fruit = BallWithGap();
  const FruitCloud bridged = BridgeGaps(fruit, SkinMap(fruit), 2.5);
  ASSERT_GT(bridged.size(), fruit.size() + 500);
  ASSERT_EQ(bridged.lab.size(), bridged.size());
  for (std::size_t i = fruit.size(); i < bridged.size(); ++i) {
    const Eigen::Vector3f& x = bridged.offsets[i];
    ASSERT_NEAR(x.norm(), 18, 1e-3);
    ASSERT_GT(x.z(), 18 * -0.56);  // the hidden cap stays empty
    if (std::abs(x.x()) < 0.9f) {
      ASSERT_NEAR(bridged.colours[i][1], 120 - 30 * x.x(), 20);
    }
  }
}

TEST(BridgeGaps, ZeroWidthAddsNothing) {
  const FruitCloud fruit = BallWithGap();
  EXPECT_EQ(BridgeGaps(fruit, SkinMap(fruit), 0).size(), fruit.size());
}

// A patch of 1 mm in the middle of a brown disc of 2 mm, the rest of which was not significant.
TEST(BuildTransitionField, OutlineStaysNearItsPatch) {
  FruitCloud fruit;
  fruit.surface = Sphere(18);
  fruit.observed_share = 1;
  constexpr int kPoints = 160000;
  for (int k = 0; k < kPoints; ++k) {
    const double x = 1 - (2.0 * k + 1) / kPoints, azimuth = 2 * std::numbers::pi * std::numbers::phi * k;
    const double ring = std::sqrt(1 - x * x);
    fruit.offsets.push_back(
        (18 * Eigen::Vector3d(x, ring * std::cos(azimuth), ring * std::sin(azimuth))).cast<float>());
    fruit.colours.push_back(18 * std::acos(x) < 2 ? Rgb8(100, 90, 60) : Rgb8(100, 150, 50));
    fruit.lab.push_back(LabFromSrgb(fruit.colours.back()));
  }
  const SkinMap map(fruit);
  Patch patch;
  std::vector<std::int32_t> patch_of(map.size(), -1);
  for (int cell = 0; cell < map.size(); ++cell) {
    const double away = 18 * std::acos(map.map().DirectionOf(cell).x());
    if (away < 2) patch_of[cell] = -2;
    if (away >= 1) continue;
    patch_of[cell] = 0;
    patch.cells.push_back(cell);
    patch.area_mm2 += map.AreaOf(cell);
  }
  const auto field = BuildTransitionField(fruit, map, patch, 0, patch_of);
  ASSERT_TRUE(field.has_value());
  for (int row = 0; row < field->height; ++row) {
    for (int column = 0; column < field->width; ++column) {
      const double away = field->FlatOf(column, row).norm();
      const float level = field->level[static_cast<std::size_t>(row) * field->width + column];
      if (away < 1) {
        ASSERT_GT(level, 0.9f);
      }
      if (away > 1.75) {
        ASSERT_LE(level, 0.01f);
      }
    }
  }
}

TransitionField FieldOfColours(const FruitSurface& surface, const Eigen::Vector3d& healthy,
                               const Eigen::Vector3d& defect) {
  TransitionField field{.chart = SkinChart(surface, Eigen::Vector3d::UnitX())};
  field.healthy_linear = healthy;
  field.defect_linear = defect;
  field.noise = 0.1;
  return field;
}

TEST(StandsOut, LightDoesNotAndStainsAndPaleScarsDo) {
  const FruitSurface surface = Sphere(18);
  const Eigen::Vector3d skin(0.25, 0.30, 0.05);
  const auto stands_out = [&](const Eigen::Vector3d& colour) {
    return StandsOut(FieldOfColours(surface, skin, colour), 9, {});
  };
  EXPECT_FALSE(stands_out(skin + Eigen::Vector3d::Constant(0.02)));       // a veil
  EXPECT_FALSE(stands_out(skin + Eigen::Vector3d(0.40, 0.41, 0.42)));     // a highlight
  EXPECT_FALSE(stands_out(1.5 * skin + Eigen::Vector3d::Constant(0.1)));  // better lit, and glossy
  EXPECT_FALSE(stands_out({0.375, 0.45, 0.065}));                         // better lit
  EXPECT_TRUE(stands_out({0.375, 0.45, 0.01}));                           // a yellow blotch
  EXPECT_TRUE(stands_out({0.15, 0.14, 0.05}));
  EXPECT_TRUE(stands_out({0.60, 0.50, 0.40}));
}

// Three times as bright as the skin, in its hue.
TEST(StandsOut, BrightSkinBetweenShadowsDoesNotAndAPaleScarDoes) {
  const FruitSurface surface = Sphere(18);
  TransitionField field = DiscField(surface, false, false);
  field.healthy_linear = {0.155, 0.088, 0.036};
  field.defect_linear = {0.461, 0.315, 0.157};
  field.noise = 0.1;
  field.blur = 0.07;
  DefectOptions options;
  EXPECT_TRUE(StandsOut(field, 9, options));
  for (int row = 0; row < field.height; ++row) {  // softer on one side, and no disc
    for (int column = 0; column < field.width; ++column) {
      const Eigen::Vector2d p = field.FlatOf(column, row);
      const double length = p.x() > 0 ? p.x() / 2.5 : p.x();
      const double level = 0.5 + (1 - std::hypot(length, p.y())) / (p.x() > 0 ? 1.2 : 0.4);
      field.level[static_cast<std::size_t>(row) * field.width + column] =
          static_cast<float>(std::clamp(level, 0.0, 1.0));
    }
  }
  field.full_level = field.level;
  EXPECT_FALSE(StandsOut(field, 9, options));
}

// On brown skin, to which bleaching adds nearly white light, and gloss white light.
TEST(StandsOut, AnEvenSpotOfGlossDoesNotAndAPaleOneThatIsNotQuiteWhiteDoes) {
  const FruitSurface surface = Sphere(18);
  TransitionField field = DiscField(surface, false, false);
  field.full_level = field.level;
  field.noise = 0.1;
  field.blur = 0.07;
  field.healthy_linear = {0.155, 0.089, 0.044};
  field.defect_linear = {0.362, 0.312, 0.252};
  EXPECT_TRUE(StandsOut(field, 9, {}));
  field.defect_linear = field.healthy_linear + Eigen::Vector3d::Constant(0.22);
  EXPECT_FALSE(StandsOut(field, 9, {}));
}

// Yellow skin that bleaching made brighter by nearly white light, and gloss by white: so near the two, the border
// counts too.
TEST(StandsOut, ASpotNearlyInTheColourOfGlossDoesByABorderTooSharpForGloss) {
  const FruitSurface surface = Sphere(18);
  TransitionField field = DiscField(surface, false, false);
  field.noise = 0.05;
  field.blur = 0.06;
  field.healthy_linear = {0.256, 0.200, 0.044};
  const auto stands_out = [&](const Eigen::Vector3d& colour, double edge_mm) {
    field.defect_linear = colour;
    for (int row = 0; row < field.height; ++row) {
      for (int column = 0; column < field.width; ++column) {
        const double level = 0.5 + (1 - field.FlatOf(column, row).norm()) / edge_mm;
        field.level[static_cast<std::size_t>(row) * field.width + column] =
            static_cast<float>(std::clamp(level, 0.0, 1.0));
      }
    }
    field.full_level = field.level;
    return StandsOut(field, 9, {});
  };
  const Eigen::Vector3d bleached(0.378, 0.299, 0.159), glossy = field.healthy_linear + Eigen::Vector3d::Constant(0.11);
  EXPECT_TRUE(stands_out(bleached, 0.25));
  EXPECT_FALSE(stands_out(bleached, 0.45));
  EXPECT_FALSE(stands_out(glossy, 0.25));
}

TEST(StandsOut, NotFromSkinThatIsAsUneven) {
  const FruitSurface surface = Sphere(18);
  TransitionField field = FieldOfColours(surface, {0.25, 0.30, 0.05}, {0.15, 0.14, 0.05});
  EXPECT_TRUE(StandsOut(field, 9, {}));
  field.noise = 0.4;
  EXPECT_FALSE(StandsOut(field, 9, {}));
}

TEST(Classify, ByShapeSizeAndColour) {
  const auto classify = [](double a, double b, double step) {
    return Classify(ShapeOf(Ellipse(a, b, 100), std::numbers::pi * a * b, step), {}).defect_class;
  };
  EXPECT_EQ(classify(1.1, 1.0, -15), DefectClass::kRainSpot);
  EXPECT_EQ(classify(4.6, 4.2, -25), DefectClass::kDecay);
  EXPECT_EQ(classify(4, 0.8, 0), DefectClass::kScar);
  EXPECT_EQ(classify(4, 0.25, -30), DefectClass::kCrack);
  EXPECT_EQ(classify(4, 0.25, 3), DefectClass::kScar);  // narrow, but not dark
  EXPECT_EQ(classify(4, 0.25, -8), DefectClass::kScar);
  DefectShape on_dark_skin = ShapeOf(Ellipse(4, 0.25, 100), std::numbers::pi, -8);
  on_dark_skin.skin_lightness = 28;
  EXPECT_EQ(Classify(on_dark_skin, {}).defect_class, DefectClass::kCrack);
}

TEST(Classify, AThreadSunkAtAllIsACrackOfAnyColour) {
  DefectShape thread = ShapeOf(Ellipse(4, 0.25, 100), std::numbers::pi, 0);
  thread.depth_mm = 0.09;
  thread.depth_uncertainty_mm = 0.015;
  EXPECT_EQ(Classify(thread, {}).defect_class, DefectClass::kCrack);
  DefectShape shorter = ShapeOf(Ellipse(1.5, 0.25, 100), 0.375 * std::numbers::pi, 0);
  shorter.depth_mm = thread.depth_mm;
  shorter.depth_uncertainty_mm = thread.depth_uncertainty_mm;
  EXPECT_EQ(Classify(shorter, {}).defect_class, DefectClass::kScar);
  thread.depth_uncertainty_mm = 0.04;  // or the skin's own unevenness
  EXPECT_EQ(Classify(thread, {}).defect_class, DefectClass::kScar);
}

// Black skin, on which the black of a crack makes no step; cork and bare flesh are pale on it.
TEST(Classify, AThreadAsBlackAsTheSkinIsACrackAndAPaleOneIsAScar) {
  DefectShape thread = ShapeOf(Ellipse(4, 0.25, 100), std::numbers::pi, 3.5);
  thread.skin_lightness = 17.5;
  thread.depth_mm = 0.019;
  thread.depth_uncertainty_mm = 0.011;
  EXPECT_EQ(Classify(thread, {}).defect_class, DefectClass::kCrack);
  thread.lightness_step = 35;
  EXPECT_EQ(Classify(thread, {}).defect_class, DefectClass::kScar);
  thread.lightness_step = 10;  // a scar in deep shade
  EXPECT_EQ(Classify(thread, {}).defect_class, DefectClass::kScar);
  DefectShape broad = ShapeOf(Ellipse(4, 0.8, 100), 3.2 * std::numbers::pi, 3.5);
  broad.skin_lightness = thread.skin_lightness;
  EXPECT_EQ(Classify(broad, {}).defect_class, DefectClass::kScar);
}

TEST(Classify, ConfidenceFallsTowardsAThreshold) {
  const ClassOptions options;
  DefectShape shape{.area_mm2 = 3, .elongation = 1.1, .width_mm = 2, .lightness_step = -15};
  const double clear = Classify(shape, options).confidence;
  shape.area_mm2 = 19.9;
  const double unclear = Classify(shape, options).confidence;
  EXPECT_GT(clear, 0.95);
  EXPECT_LT(unclear, 0.6);
}

TEST(IsEstablished, NotWithARaggedOutlineOnBadlySeenSkin) {
  Defect defect;
  defect.area_mm2 = 1.8;
  defect.length_mm = 2.0;
  defect.width_mm = 1.15;
  defect.area_uncertainty_mm2 = 0.24;
  EXPECT_TRUE(IsEstablished(defect));
  defect.area_uncertainty_mm2 = 0.27;
  EXPECT_FALSE(IsEstablished(defect));
  defect.completed = true;
  EXPECT_TRUE(IsEstablished(defect));
  defect.completed = false;
  defect.length_mm = 4;
  defect.width_mm = 0.55;
  EXPECT_TRUE(IsEstablished(defect));
}

}  // namespace
}  // namespace drupe
