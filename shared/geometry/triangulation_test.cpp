#include "geometry/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "geometry/p3p.h"

namespace drupe {
namespace {

/// A camera `distance` from the origin, turned by `angle_rad` about the vertical, looking at the origin.
Rigid3 OnRing(double angle_rad, double distance) {
  Rigid3 pose;
  pose.rotation = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation = Eigen::Vector3d(0, 0, distance);
  return pose;
}

RayObservation See(const Rigid3& pose, const Eigen::Vector3d& point) {
  return {pose, (pose * point).hnormalized()};
}

TEST(TriangulationTest, NominalFindsThePoint) {
  const Eigen::Vector3d point(3, -2, 5);
  std::vector<RayObservation> rays;
  for (int i = 0; i < 4; ++i) rays.push_back(See(OnRing(0.1 * i, 200), point));
  const auto found = Triangulate(rays);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - point).norm(), 1e-9);
  EXPECT_LT(ReprojectionError(rays[2], *found), 1e-12);
}

TEST(TriangulationTest, LeastSquaresBeatsEitherSideOfTheMinimum) {
  const Eigen::Vector3d point(3, -2, 5);
  std::vector<RayObservation> rays;
  for (int i = 0; i < 5; ++i) {
    rays.push_back(See(OnRing(0.1 * i, 200), point));
    rays.back().xy += 1e-3 * Eigen::Vector2d(std::sin(3.0 * i), std::cos(5.0 * i));
  }
  const auto cost = [&](const Eigen::Vector3d& x) {
    double sum = 0;
    for (const RayObservation& ray : rays) sum += std::pow(ReprojectionError(ray, x), 2);
    return sum;
  };
  const auto found = Triangulate(rays);
  ASSERT_TRUE(found);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = 0.01 * Eigen::Vector3d::Unit(axis);
    EXPECT_GT(cost(*found + step), cost(*found));
    EXPECT_GT(cost(*found - step), cost(*found));
  }
}

TEST(TriangulationTest, DegenerateRaysHaveNoPoint) {
  const Rigid3 pose = OnRing(0.3, 200);
  const std::vector<RayObservation> same = {See(pose, {1, 2, 3}), See(pose, {1, 2, 3})};
  EXPECT_FALSE(Triangulate(same));
  EXPECT_FALSE(Triangulate(std::vector<RayObservation>{same[0]}));
  // Rays that meet behind both cameras.
  std::vector<RayObservation> behind = {See(OnRing(0, 200), {0, 0, 0}), See(OnRing(0.2, 200), {0, 0, 0})};
  behind[0].xy.x() -= 0.5, behind[1].xy.x() += 0.5;
  EXPECT_FALSE(Triangulate(behind));
}

TEST(TriangulationTest, WidestAngleIsThatBetweenTheOuterCameras) {
  std::vector<RayObservation> rays;
  for (int i = 0; i < 4; ++i) rays.push_back(See(OnRing(0.1 * i, 200), Eigen::Vector3d::Zero()));
  EXPECT_NEAR(std::acos(SmallestRayCosine(rays, Eigen::Vector3d::Zero())), 0.3, 1e-9);
  EXPECT_EQ(SmallestRayCosine({}, Eigen::Vector3d::Zero()), 1.0);
}

TEST(P3pTest, OneSolutionIsTheTruePose) {
  for (int trial = 0; trial < 200; ++trial) {
    Rigid3 pose = OnRing(0.03 * trial, 150 + trial);
    pose.rotation = pose.rotation * Eigen::AngleAxisd(0.7 * trial, Eigen::Vector3d(1, 2, 3).normalized());
    std::array<Eigen::Vector3d, 3> points;
    std::array<Eigen::Vector2d, 3> rays;
    for (int i = 0; i < 3; ++i) {
      points[i] =
          30 * Eigen::Vector3d(std::sin(7.1 * trial + i), std::cos(3.3 * trial + 2 * i), std::sin(trial + 5 * i));
      rays[i] = (pose * points[i]).hnormalized();
    }
    double nearest = 1e9;
    for (const Rigid3& found : SolveP3p(points, rays)) {
      EXPECT_NEAR(found.rotation.determinant(), 1, 1e-9);
      nearest = std::min(nearest, (found.rotation - pose.rotation).norm() +
                                      (found.translation - pose.translation).norm() / pose.translation.norm());
    }
    EXPECT_LT(nearest, 1e-5) << trial;
  }
}

TEST(P3pTest, PointsOnALineHaveNoPose) {
  const std::array<Eigen::Vector3d, 3> points = {Eigen::Vector3d(0, 0, 10), {1, 0, 10}, {2, 0, 10}};
  EXPECT_TRUE(SolveP3p(points, {Eigen::Vector2d(0, 0), {0.1, 0}, {0.2, 0}}).empty());
}

}  // namespace
}  // namespace drupe
