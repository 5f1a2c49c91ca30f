#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "defect_analysis/defects/outline_shape.h"
#include "defect_analysis/defects/round_outline.h"
#include "defect_analysis/defects/stain_edge.h"
#include "defect_analysis/defects/test_shapes.h"

namespace drupe {
namespace {

using std::numbers::pi;

TEST(CompleteOutline, ClosesACircleOfWhichTwoThirdsAreSeen) {
  const auto completed = CompleteOutline(ArcOf({2, -1}, 0.8, 0.3, 0.3 + 1.35 * pi, 90));
  ASSERT_TRUE(completed.has_value());
  EXPECT_NEAR(SignedArea(completed->polygon), pi * 0.64, 0.02);
  EXPECT_NEAR(completed->seen_share, 0.68, 0.03);
  EXPECT_LT(completed->rms, 0.01);
}

TEST(CompleteOutline, RefusesAShortArc) {
  EXPECT_FALSE(CompleteOutline(ArcOf({0, 0}, 1, 0, 0.5, 40)).has_value());
}

// Two circles of radius 1 that overlap by 0.4 mm: an hourglass.
TEST(SplitAtNeck, PartsTwoTouchingDiscs) {
  const double angle = std::acos(0.8);
  Polygon outline = ArcOf({-0.8, 0}, 1, angle, 2 * pi - angle, 150);
  const Polygon right = ArcOf({0.8, 0}, 1, angle - pi, pi - angle, 150);
  outline.insert(outline.end(), right.begin(), right.end());
  const auto parts = SplitAtNeck(outline, 0.35);
  ASSERT_EQ(parts.size(), 2u);
  for (const Polygon& part : parts) EXPECT_NEAR(SignedArea(part), pi, 0.03 * pi);
}

// They overlap by 0.68 mm: the neck is 0.75 of their width.
TEST(SplitAtNeck, PartsTwoDiscsWithAWideNeck) {
  const double angle = std::acos(0.66);
  Polygon outline = ArcOf({-0.66, 0}, 1, angle, 2 * pi - angle, 150);
  const Polygon right = ArcOf({0.66, 0}, 1, angle - pi, pi - angle, 150);
  outline.insert(outline.end(), right.begin(), right.end());
  const auto parts = SplitAtNeck(outline, 0.35);
  ASSERT_EQ(parts.size(), 2u);
  for (const Polygon& part : parts) EXPECT_NEAR(SignedArea(part), pi, 0.04 * pi);
}

TEST(SplitAtNeck, LeavesABeanWhole) {
  Polygon bean = ArcOf({0, 0}, 1, 0, 2 * pi, 240);
  for (Eigen::Vector2d& p : bean) p = {1.35 * p.x(), 0.9 * p.y() * (1 - 0.12 * std::exp(-4 * p.x() * p.x()))};
  EXPECT_EQ(SplitAtNeck(bean, 0.35).size(), 1u);
}

TEST(SplitAtNeck, LeavesASpotAndAScarWhole) {
  EXPECT_EQ(SplitAtNeck(ArcOf({0, 0}, 1, 0, 2 * pi, 200), 0.35).size(), 1u);
  Polygon scar = ArcOf({0, 0}, 1, 0, 2 * pi, 200);
  for (Eigen::Vector2d& p : scar) p = {5 * p.x(), 0.8 * p.y() * (1 + 0.1 * std::cos(3 * p.x()))};
  EXPECT_EQ(SplitAtNeck(scar, 0.35).size(), 1u);
}

// A third of the arc's end bends outward, as an outline does where it meets another one.
TEST(CompleteOutline, IsNotDrawnByEndsThatBend) {
  Polygon arc = ArcOf({0, 0}, 0.6, 0.2 * pi, 1.6 * pi, 120);
  for (int k = 0; k < 8; ++k) {
    arc[k] *= 1 + 0.02 * (8 - k);
    arc[119 - k] *= 1 + 0.02 * (8 - k);
  }
  const auto completed = CompleteOutline(arc);
  ASSERT_TRUE(completed.has_value());
  EXPECT_NEAR(SignedArea(completed->polygon) / (pi * 0.36), 1, 0.02);
}

// A disc with lobes, a horn 0.5 mm long and a bay 0.2 mm deep.
TEST(RepairRoundOutline, TakesHornsAndBaysOff) {
  const auto radius = [](double t) { return 1 + 0.04 * std::cos(3 * t) + 0.06 * std::cos(2 * t + 1); };
  Polygon clean, damaged;
  for (int k = 0; k < 200; ++k) {
    const double t = 2 * pi * (k + 0.5) / 200;
    const Eigen::Vector2d out(std::cos(t), std::sin(t));
    const double horn = 0.5 * std::exp(-std::pow((t - 1) / 0.12, 2)),
                 bay = 0.2 * std::exp(-std::pow((t - 4) / 0.15, 2));
    clean.push_back(radius(t) * out);
    damaged.push_back((radius(t) + horn - bay) * out);
  }
  const auto repaired = RepairRoundOutline(damaged);
  ASSERT_TRUE(repaired.has_value());
  EXPECT_GT(std::abs(SignedArea(damaged) / SignedArea(clean) - 1), 0.015);
  EXPECT_NEAR(SignedArea(*repaired) / SignedArea(clean), 1, 0.005);
  EXPECT_FALSE(RepairRoundOutline(clean).has_value());
}

TEST(RepairRoundOutline, LeavesAnIrregularOutlineAlone) {
  Polygon star = ArcOf({0, 0}, 1, 0, 2 * pi, 240);
  for (int k = 0; k < 240; ++k) star[k] *= 1 + 0.3 * std::cos(2 * pi * 9 * k / 240);
  EXPECT_FALSE(RepairRoundOutline(star).has_value());
}

// A field of 6 x 6 mm whose level falls from 1 to 0 over `edge` mm about 1 mm from the middle.
TransitionField DiscField(const FruitSurface& surface, double edge, double open_from) {
  TransitionField field{.chart = SkinChart(surface, Eigen::Vector3d::UnitX())};
  field.width = field.height = 120;
  field.step = 0.05;
  field.origin = Eigen::Vector2d(-3, -3);
  field.blur = 0.06;
  for (int row = 0; row < field.height; ++row) {
    for (int column = 0; column < field.width; ++column) {
      const Eigen::Vector2d p = field.FlatOf(column, row);
      const double width = p.y() > open_from ? 2 : edge;
      field.level.push_back(static_cast<float>(std::clamp(0.5 + (1 - p.norm()) / width, 0.0, 1.0)));
      field.inside.push_back(field.level.back() > 0.3f ? 1 : 0);
    }
  }
  field.full_level = field.level;
  return field;
}

TEST(HasStainsEdge, ASpotHasAndAHighlightHasNot) {
  const FruitSurface ball(Eigen::Vector3d::Zero(),
                          CubeTable<float>::Of(8, [](const Eigen::Vector3d&) { return 18.0f; }));
  constexpr double kNowhere = 9;
  EXPECT_TRUE(HasStainsEdge(DiscField(ball, 0.3, kNowhere), 0.5, 0.35));
  EXPECT_FALSE(HasStainsEdge(DiscField(ball, 1.5, kNowhere), 0.5, 0.35));
  EXPECT_FALSE(HasStainsEdge(DiscField(ball, 0.3, 0), 0.5, 0.35));  // sharp on one side only
  EXPECT_FALSE(HasStainsEdge(DiscField(ball, 0.3, kNowhere), 0.5, 4));
}

}  // namespace
}  // namespace drupe
