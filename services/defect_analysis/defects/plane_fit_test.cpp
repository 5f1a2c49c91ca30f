#include "defect_analysis/defects/plane_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace drupe {
namespace {

// A dish: a plane patch of 2 mm with points of a shallow bowl in it.
std::vector<Eigen::Vector3d> Dish() {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 2000; ++k) {
    const double x = uniform(random), y = uniform(random), r = std::hypot(x, y);
    points.emplace_back(x, y, r < 0.5 ? -0.2 * (0.5 - r) : 0);
  }
  return points;
}

TEST(FitDefectPlane, TheDistanceInMillimetresReplacesTheShare) {
  PlaneOptions share, wide;
  share.iterations = wide.iterations = 50;
  wide.distance_mm = 1;  // everything is an inlier, the bowl pulls
  const auto close = FitDefectPlane(Dish(), Eigen::Vector3d::UnitZ(), 0, share, 1);
  const auto all = FitDefectPlane(Dish(), Eigen::Vector3d::UnitZ(), 0, wide, 1);
  ASSERT_TRUE(close.ok() && all.ok());
  EXPECT_NEAR(close->offset_mm, 0, 1e-3);
  EXPECT_LT(all->offset_mm, -0.004);
  EXPECT_GT(all->rms_mm, 5 * close->rms_mm);
  EXPECT_NEAR(close->mean_abs_z_mm, 0.2 * 0.5 * (3.14159 * 0.25 / 4) / 3, 1e-3);
}

// A strip of 0.3 mm that runs 12 mm round a ball of 18 mm lies well in a plane across the skin.
TEST(FitDefectPlane, DoesNotCutAcrossTheSkinUnderACrack) {
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 600; ++k) {
    const double along = (k % 120 / 119.0 - 0.5) * 12 / 18, across = (k / 120 - 2) * 0.075 / 18;
    points.push_back(18 * Eigen::Vector3d(std::sin(along), std::sin(across), std::cos(along)).normalized());
  }
  const auto plane = FitDefectPlane(points, Eigen::Vector3d::UnitZ(), 0.02, {}, 1);
  EXPECT_TRUE(!plane.ok() || plane->normal.z() > 0.5);
  PlaneOptions more;
  more.iterations = 500;
  const auto found = FitDefectPlane(points, Eigen::Vector3d::UnitZ(), 0.02, more, 1);
  ASSERT_TRUE(found.ok());
  EXPECT_GT(found->normal.z(), 0.5);
}

}  // namespace
}  // namespace drupe
