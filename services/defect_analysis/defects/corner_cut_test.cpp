#include "defect_analysis/defects/corner_cut.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "defect_analysis/defects/outline_shape.h"
#include "defect_analysis/defects/test_shapes.h"

namespace drupe {
namespace {

using std::numbers::pi;

// What lies within `radius(turn)` of the origin or within `other(turn)` of (away, 0), as seen from the origin.
template <typename Radius, typename Other>
Polygon JointOutline(const Radius& radius, double away, const Other& other) {
  Polygon outline;
  constexpr int kPoints = 400;
  for (int k = 0; k < kPoints; ++k) {
    const double turn = 2 * pi * (k + 0.5) / kPoints;
    const Eigen::Vector2d out(std::cos(turn), std::sin(turn));
    double reach = radius(turn);
    for (double at = reach; at < 5; at += 0.002) {
      const Eigen::Vector2d offset = at * out - Eigen::Vector2d(away, 0);
      if (offset.norm() < other(std::atan2(offset.y(), offset.x()))) reach = at;
    }
    outline.push_back(reach * out);
  }
  return outline;
}

auto Circle(double radius) {
  return [radius](double) { return radius; };
}

double LargeLobed(double t) {
  return 1.5 * (1 + 0.04 * std::cos(2 * t + 1) + 0.02 * std::cos(3 * t));
}

double SmallLobed(double t) {
  return 0.75 * (1 + 0.04 * std::cos(2 * t) + 0.02 * std::cos(3 * t + 2));
}

// Their joint outline is nowhere narrower than 0.9 of the smaller one.
TEST(CutAtCorners, PartsTwoSpotsThatHaveGrownTogether) {
  const Polygon outline = JointOutline(LargeLobed, 1.85, SmallLobed);
  const auto parts = SplitAtNeck(outline, 0.35);
  ASSERT_EQ(parts.size(), 2u);
  const double large = std::max(SignedArea(parts[0]), SignedArea(parts[1]));
  const double small = std::min(SignedArea(parts[0]), SignedArea(parts[1]));
  EXPECT_NEAR(large / (pi * 1.5 * 1.5), 1, 0.02);
  EXPECT_NEAR(small / (pi * 0.75 * 0.75), 1, 0.06);
  EXPECT_EQ(SplitAtNeck(outline, 2.5).size(), 1u);
}

// The waist is as narrow, but it has no corners.
TEST(CutAtCorners, LeavesASmoothWaistWhole) {
  Polygon outline = ArcOf({0, 0}, 1, 0, 2 * pi, 400);
  for (Eigen::Vector2d& p : outline) p *= 1.5 * (1 + 0.25 * std::cos(2 * std::atan2(p.y(), p.x())));
  EXPECT_FALSE(CutAtCorners(outline, 0.35).has_value());
}

// A wedge that shade draws out of a spot's rim: 1.1 mm wide and 0.85 mm long.
TEST(CutAtCorners, LeavesASpotWithAHornWhole) {
  const auto radius = [](double t) {
    return 1.5 + std::max(0.0, 0.85 * (1 - std::abs(std::remainder(t, 2 * pi)) / 0.37));
  };
  EXPECT_FALSE(CutAtCorners(JointOutline(radius, 0, Circle(0)), 0.35).has_value());
}

// A bulge nearly twice as long as wide, as a scar's end or a smear is.
TEST(CutAtCorners, LeavesASpotWithALongBulgeWhole) {
  const auto bulge = [](double t) { return 0.7 * (1 + 0.33 * std::cos(2 * t)); };
  EXPECT_FALSE(CutAtCorners(JointOutline(Circle(1.5), 2.3, bulge), 0.35).has_value());
  const auto round = [](double t) { return 0.7 * (1 + 0.05 * std::cos(2 * t)); };
  EXPECT_TRUE(CutAtCorners(JointOutline(Circle(1.5), 2.1, round), 0.35).has_value());
}

// Gloss bites in from both sides: either half is an arc of the one disc.
TEST(CutAtCorners, LeavesASpotWithTwoBaysWhole) {
  const auto radius = [](double t) {
    const double away =
        std::min(std::abs(std::remainder(t - pi / 2, 2 * pi)), std::abs(std::remainder(t + pi / 2, 2 * pi)));
    return 1.5 - std::max(0.0, 0.3 * (1 - away / 0.12));
  };
  EXPECT_FALSE(CutAtCorners(JointOutline(radius, 0, Circle(0)), 0.35).has_value());
}

TEST(CutAtCorners, LeavesAnIrregularPatchWhole) {
  Polygon outline = ArcOf({0, 0}, 1, 0, 2 * pi, 600);
  for (Eigen::Vector2d& p : outline) {
    const double t = std::atan2(p.y(), p.x());
    p *= 4 * (1 + 0.12 * std::cos(2 * t) + 0.08 * std::cos(3 * t + 1) + 0.12 * std::abs(std::sin(2.5 * t)));
  }
  EXPECT_FALSE(CutAtCorners(outline, 0.35).has_value());
}

}  // namespace
}  // namespace drupe
