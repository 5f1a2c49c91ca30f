#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

// The flanks are continued over the unseen pole; what is at the seen one alone, a tip or the stalk's hollow, is not.
TEST(FitClosedSurface, ATipIsNotMirroredToTheUnseenPole) {
  for (const double tip : {1.0, -1.0}) {
    std::vector<Eigen::Vector3d> points;
    constexpr int kPoints = 60000;
    for (int k = 0; k < kPoints; ++k) {
      const double z = 1 - (2.0 * k + 1) / kPoints, azimuth = 2 * std::numbers::pi * std::numbers::phi * k;
      if (z < -0.75) continue;
      const double ring = std::sqrt(1 - z * z), radius = 18 + tip * std::exp(-std::pow(std::acos(z) / 0.25, 2));
      points.emplace_back(radius * ring * std::cos(azimuth), radius * ring * std::sin(azimuth), radius * z);
    }
    const auto closed = FitClosedSurface(points, Eigen::Vector3d::UnitZ(), {});
    ASSERT_TRUE(closed.ok());
    EXPECT_NEAR(closed->surface.PointAt(-Eigen::Vector3d::UnitZ()).z(), -18, 0.25);
  }
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

// A ball whose closed surface passes over a groove of a twentieth of its points, 1 mm deep.
TEST(MeasureTraits, AGrooveThatTheSurfacePassesOverIsNoPartOfTheVolume) {
  FruitCloud fruit;
  fruit.surface =
      FruitSurface(Eigen::Vector3d::Zero(), CubeTable<float>::Of(64, [](const Eigen::Vector3d&) { return 18.0f; }));
  constexpr int kPoints = 200000;
  for (int k = 0; k < kPoints; ++k) {
    const double z = 1 - (2.0 * k + 1) / kPoints, azimuth = 2 * std::numbers::pi * std::numbers::phi * k;
    const double ring = std::sqrt(1 - z * z);
    const Eigen::Vector3d d(ring * std::cos(azimuth), ring * std::sin(azimuth), z);
    const bool groove = std::abs(std::atan2(d.y(), d.x())) < std::numbers::pi / 20;
    fruit.offsets.push_back(((groove ? 17 : 18) * d).cast<float>());
    fruit.lab.push_back(Eigen::Vector3f::Zero());
  }
  const double ball = 4.0 / 3 * std::numbers::pi * 18 * 18 * 18, groove = ball * (1 - std::pow(17.0 / 18, 3)) / 20;
  EXPECT_NEAR((ball - MeasureTraits(fruit).volume_mm3) / groove, 1, 0.1);
}

TEST(ParseFruitOptions, NamesTheFieldOutOfRange) {
  const auto options = ParseFruitOptions(Json{{"surface_degree", 99}}, "options.fruit");
  ASSERT_FALSE(options.ok());
  EXPECT_EQ(options.status().field(), "fruit.surface_degree");
}

}  // namespace
}  // namespace drupe
