#include "reconstruction/sparse/pose_estimation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace drupe {
namespace {

Rigid3 TruePose() {
  Rigid3 pose;
  pose.rotation = (Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(-1.1, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  pose.translation = Eigen::Vector3d(5, -8, 220);
  return pose;
}

/// Points in a box (or on a plane), a share of them seen in a wrong place.
std::vector<PointCorrespondence> MakeCorrespondences(int count, double noise, double wrong_share, bool is_plane) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<PointCorrespondence> all;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d point(30 * normal(random), 30 * normal(random), is_plane ? 0.0 : 30 * normal(random));
    Eigen::Vector2d xy = (TruePose() * point).hnormalized();
    xy += noise * Eigen::Vector2d(normal(random), normal(random));
    if (uniform(random) < wrong_share) xy = Eigen::Vector2d(uniform(random) - 0.5, uniform(random) - 0.5);
    all.push_back({point, xy});
  }
  return all;
}

double PoseError(const Rigid3& pose) {
  return (pose.rotation - TruePose().rotation).norm() + (pose.translation - TruePose().translation).norm() / 220;
}

TEST(PoseEstimationTest, NominalWithHalfWrong) {
  const auto all = MakeCorrespondences(200, 1e-4, 0.5, false);
  const auto estimate = EstimatePose(all, PoseEstimationOptions{.max_error = 1e-3});
  ASSERT_TRUE(estimate);
  EXPECT_LT(PoseError(estimate->cam_from_world), 1e-3);
  EXPECT_GT(estimate->inlier_count, 80);
}

TEST(PoseEstimationTest, PlaneIsNoSpecialCase) {
  const auto all = MakeCorrespondences(100, 1e-4, 0.2, true);
  const auto estimate = EstimatePose(all, PoseEstimationOptions{.max_error = 1e-3});
  ASSERT_TRUE(estimate);
  EXPECT_LT(PoseError(estimate->cam_from_world), 2e-3);
}

TEST(PoseEstimationTest, SameSeedSameResult) {
  const auto all = MakeCorrespondences(100, 1e-3, 0.4, false);
  const auto a = EstimatePose(all, PoseEstimationOptions{}), b = EstimatePose(all, PoseEstimationOptions{});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->cam_from_world.translation, b->cam_from_world.translation);
  EXPECT_EQ(a->is_inlier, b->is_inlier);
}

TEST(PoseEstimationTest, TooFewHaveNoPose) {
  const auto all = MakeCorrespondences(3, 0, 0, false);
  EXPECT_FALSE(EstimatePose(all, PoseEstimationOptions{}));
}

TEST(PoseEstimationTest, RefinementLeavesOutliersOut) {
  auto all = MakeCorrespondences(60, 0, 0, false);
  all[0].xy += Eigen::Vector2d(0.3, 0.1);
  std::vector<std::uint8_t> use(all.size(), 1);
  use[0] = 0;
  Rigid3 start = TruePose();
  start.translation += Eigen::Vector3d(3, -2, 6);
  start.rotation = Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitZ()).toRotationMatrix() * start.rotation;
  EXPECT_LT(PoseError(RefinePose(start, all, use, 0.01)), 1e-9);
}

}  // namespace
}  // namespace drupe
