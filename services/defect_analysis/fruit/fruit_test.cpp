#include <gtest/gtest.h>

#include "defect_analysis/fruit/closed_surface.h"
#include "defect_analysis/fruit/extract_fruits.h"
#include "defect_analysis/fruit/ground.h"
#include "defect_analysis/fruit/objects.h"
#include "defect_analysis/fruit/traits.h"
#include "scene/synthetic_fruit.h"

namespace drupe {
namespace {

std::vector<Eigen::Vector3d> PointsOf(const PointCloud& cloud) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& x : cloud.positions) points.push_back(x.cast<double>());
  return points;
}

TEST(FitSphere, IgnoresTheNeedle) {
  SyntheticFruit fruit;
  fruit.points = 5000;
  PointCloud cloud;
  fruit.AddTo(cloud);
  for (int k = 0; k < 300; ++k) cloud.positions.emplace_back(0.5f, -0.4f, 0.05f * static_cast<float>(k));
  const auto sphere = FitSphere(PointsOf(cloud));
  ASSERT_TRUE(sphere.ok());
  EXPECT_LT((sphere->centre - fruit.centre).norm(), 0.1);
  EXPECT_NEAR(sphere->radius, 18, 0.1);
}

TEST(FitClosedSurface, AreaAndVolumeOfAnEllipsoid) {
  SyntheticFruit fruit;
  fruit.equatorial_mm = 17;
  fruit.polar_mm = 19;
  fruit.points = 40000;
  PointCloud cloud;
  fruit.AddTo(cloud);
  const auto closed = FitClosedSurface(PointsOf(cloud), Eigen::Vector3d::UnitZ(), {});
  ASSERT_TRUE(closed.ok());
  EXPECT_NEAR(closed->surface.Volume() / fruit.Volume(), 1, 0.01);
  EXPECT_NEAR(closed->observed_share, 0.9, 0.03);
  EXPECT_LT(closed->residual_mm, 0.03);
}

TEST(FitClosedSurface, APlaneIsNoFruit) {
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 10000; ++k) points.emplace_back(0.1 * (k % 100), 0.1 * (k / 100), 0);
  EXPECT_FALSE(FitClosedSurface(points, Eigen::Vector3d::UnitZ(), {}).ok());
}

TEST(FindGround, FindsATiltedBoardBelowTheFruit) {
  PointCloud cloud;
  SyntheticFruit().AddTo(cloud);
  SyntheticFruit::AddBoardAndNeedle({0.5, -0.4, 34}, cloud);
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(0.7f, Eigen::Vector3f(1, 2, 0).normalized()).toRotationMatrix();
  for (Eigen::Vector3f& x : cloud.positions) x = turn * x;
  const auto ground = FindGround(cloud, 150, {turn.cast<double>() * Eigen::Vector3d(100, 0, 90)}, 1);
  ASSERT_TRUE(ground.has_value());
  EXPECT_GT(ground->normal.dot(turn.cast<double>() * Eigen::Vector3d::UnitZ()), 0.9999);
  EXPECT_NEAR(ground->offset, 0, 0.1);
}

TEST(FindObjects, SeparatesFruitsAndDropsTheBoard) {
  SyntheticFruit a, b;
  a.points = b.points = 20000;
  a.centre.x() = -21;
  b.centre.x() = 21;
  PointCloud cloud;
  a.AddTo(cloud);
  b.AddTo(cloud);
  SyntheticFruit::AddBoardAndNeedle(a.centre, cloud);
  const auto objects = FindObjects(cloud, RobustBox(cloud), Ground{}, 3, 0.8, 400);
  ASSERT_EQ(objects.size(), 3u);  // the needle, which touches no fruit here, is the smallest object
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_GT(objects[k].size(), 17000u);
    const bool left = cloud.positions[objects[k].front()].x() < 0;
    for (const std::uint32_t i : objects[k]) ASSERT_EQ(cloud.positions[i].x() < 0, left);
  }
}

TEST(MeasureTraits, SphereHasSphericityOne) {
  PointCloud cloud;
  SyntheticFruit().AddTo(cloud);
  FruitScene scene;
  scene.metric = true;
  const auto fruits = ExtractFruits(cloud, scene, {}, {}, {});
  ASSERT_TRUE(fruits.ok());
  ASSERT_EQ(fruits->size(), 1u);
  EXPECT_NEAR((*fruits)[0].noise_mm, 0.02, 0.004);
  const Fruit fruit = MeasureTraits((*fruits)[0]);
  EXPECT_NEAR(fruit.sphericity, 1, 0.001);
  EXPECT_NEAR(fruit.equatorial_diameter_mm, 36, 0.05);
  EXPECT_NEAR(fruit.observed_surface_pct, 90, 3);
}

TEST(ParseFruitOptions, NamesTheFieldOutOfRange) {
  const auto options = ParseFruitOptions(Json{{"surface_degree", 99}}, "options.fruit");
  ASSERT_FALSE(options.ok());
  EXPECT_EQ(options.status().field(), "fruit.surface_degree");
}

}  // namespace
}  // namespace drupe
