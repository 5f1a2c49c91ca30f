#include "defect_analysis/defects/sharp_rim.h"

#include <gtest/gtest.h>

#include <cmath>

#include "defect_analysis/defects/significance.h"

namespace drupe {
namespace {

FruitSurface RimBall() {
  return FruitSurface(Eigen::Vector3d::Zero(), CubeTable<float>::Of(8, [](const Eigen::Vector3d&) { return 18.0f; }));
}

// 0 to 1 from outside to inside a strip 5 mm long, over an edge of `edge` mm.
double StripAt(const Eigen::Vector2d& p, double half_width, double edge) {
  const double off = std::hypot(std::max(0.0, std::abs(p.x()) - 2.5 + half_width), p.y());
  return std::clamp(0.5 + (half_width - off) / edge, 0.0, 1.0);
}

// A field of 7 x 4 mm with `level(place)` at its nodes.
template <typename Level>
TransitionField StripField(const FruitSurface& surface, const Level& level) {
  TransitionField field{.chart = SkinChart(surface, Eigen::Vector3d::UnitX())};
  field.width = 176;
  field.height = 101;
  field.step = 0.04;
  field.origin = Eigen::Vector2d(-3.5, -2);
  field.blur = 0.06;
  field.noise = 0.1;
  for (int row = 0; row < field.height; ++row) {
    for (int column = 0; column < field.width; ++column) {
      field.level.push_back(static_cast<float>(level(field.FlatOf(column, row))));
      field.inside.push_back(field.level.back() > 0.3f ? 1 : 0);
    }
  }
  field.full_level = field.level;
  return field;
}

TransitionField Strip(const FruitSurface& surface, double half_width, double edge) {
  return StripField(surface, [&](const Eigen::Vector2d& p) { return 0.01 + 0.99 * StripAt(p, half_width, edge); });
}

bool IsRimSharp(const TransitionField& field) {
  return HasSharpRim(field, 0.5, 0.35, 3);
}

TEST(HasSharpRim, AScarHasAndALongHighlightHasNot) {
  const FruitSurface ball = RimBall();
  EXPECT_TRUE(IsRimSharp(Strip(ball, 0.7, 0.3)));
  EXPECT_FALSE(IsRimSharp(Strip(ball, 0.7, 1.2)));
  EXPECT_FALSE(IsRimSharp(Strip(ball, 0.38, 0.2)));  // a sliver
  EXPECT_FALSE(HasSharpRim(Strip(ball, 0.7, 0.3), 0.5, 20, 3));
}

TEST(HasSharpRim, AScarHasOnSkinThatChangesAlongIt) {
  const auto level = [](const Eigen::Vector2d& p) { return StripAt(p, 0.7, 0.3) + 0.12 * p.x() + 0.02; };
  EXPECT_TRUE(IsRimSharp(StripField(RimBall(), level)));
}

TEST(HasSharpRim, ShadeThatIsSharpOnOneSideHasNot) {
  const auto level = [](const Eigen::Vector2d& p) { return 0.01 + 0.99 * StripAt(p, 0.7, p.y() > 0 ? 0.3 : 1.3); };
  EXPECT_FALSE(IsRimSharp(StripField(RimBall(), level)));
}

// Bright for a third of its length: the rest might be anything.
TEST(HasSharpRim, OneThatIsUnlikeItselfHasNot) {
  const auto level = [](const Eigen::Vector2d& p) { return 0.01 + (p.x() > 1 ? 2.0 : 0.65) * StripAt(p, 0.7, 0.2); };
  EXPECT_FALSE(IsRimSharp(StripField(RimBall(), level)));
}

TEST(HasSharpRim, OneBesideUnseenSkinHasNot) {
  const auto level = [](const Eigen::Vector2d& p) {
    const double strip = StripAt(p, 0.7, 0.3);
    return p.y() < 0 && strip == 0 ? 0 : 0.01 + 0.99 * strip;
  };
  EXPECT_FALSE(IsRimSharp(StripField(RimBall(), level)));
}

TEST(HasSharpRim, OneInPiecesHasNot) {
  const auto level = [](const Eigen::Vector2d& p) {
    const double other = std::clamp(0.5 + (0.6 - (p - Eigen::Vector2d(2.7, -1.2)).norm()) / 0.2, 0.0, 1.0);
    return 0.01 + 0.99 * std::max(StripAt(p + Eigen::Vector2d(0.8, -0.5), 0.5, 0.2), other);
  };
  EXPECT_FALSE(IsRimSharp(StripField(RimBall(), level)));
}

TEST(StandsOutFaintly, AScarOfItsOwnColourDoesAndWhatLightOrShadeColoursDoesNot) {
  constexpr double kThreshold = 5.4;
  const FruitSurface ball = RimBall();
  TransitionField field = Strip(ball, 0.7, 0.3);
  field.healthy_linear = Eigen::Vector3d(0.38, 0.378, 0.203);
  field.defect_linear = Eigen::Vector3d(0.503, 0.414, 0.265);
  EXPECT_TRUE(StandsOutFaintly(field, kThreshold, {}));
  EXPECT_FALSE(StandsOutFaintly(field, 12, {}));
  field.defect_linear = field.healthy_linear.array() + 0.13;  // gloss
  EXPECT_GT(Contrast(field, 0.5), kThreshold);
  EXPECT_FALSE(StandsOutFaintly(field, kThreshold, {}));
  field.defect_linear = 0.55 * field.healthy_linear;  // a shadow
  EXPECT_GT(Contrast(field, 0.5), kThreshold);
  EXPECT_FALSE(StandsOutFaintly(field, kThreshold, {}));
}

// 3.5 Lab units off the colour of gloss.
TEST(StandsOutFaintly, AScarNearlyInTheColourOfGlossDoesWhereItsRimIsSharper) {
  const FruitSurface ball = RimBall();
  for (const double edge : {0.25, 0.42}) {
    TransitionField field = Strip(ball, 0.9, edge);
    field.healthy_linear = Eigen::Vector3d(0.466, 0.331, 0.181);
    field.defect_linear = Eigen::Vector3d(0.556, 0.459, 0.293);
    EXPECT_TRUE(IsRimSharp(field));
    EXPECT_EQ(StandsOutFaintly(field, 5.4, {}), edge < 0.3);
  }
}

TEST(StandsOutByItsRim, AScarDoesAndAnEvenSpotWithASoftBorderDoesNot) {
  constexpr double kThreshold = 4;
  const FruitSurface ball = RimBall();
  for (const double edge : {0.3, 1.2}) {
    TransitionField field = Strip(ball, 0.7, edge);
    field.healthy_linear = Eigen::Vector3d(0.38, 0.378, 0.203);
    field.defect_linear = Eigen::Vector3d(0.44, 0.394, 0.23);
    EXPECT_NEAR(Contrast(field, 0.5), 4.6, 0.6);
    EXPECT_EQ(StandsOutByItsRim(field, kThreshold, {}), edge < 0.5);
    EXPECT_FALSE(StandsOutByItsRim(field, 5.4, {}));
  }
}

}  // namespace
}  // namespace drupe
