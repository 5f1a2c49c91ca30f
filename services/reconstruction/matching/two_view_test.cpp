// The geometry of two views: five-point solver, relative pose, homography.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "reconstruction/matching/five_point.h"
#include "reconstruction/matching/homography.h"
#include "reconstruction/matching/relative_pose.h"

namespace drupe {
namespace {

/// Random numbers that are the same on every machine.
class SceneRandom {
 public:
  explicit SceneRandom(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }

 private:
  std::mt19937_64 engine_;
};

/// A turn of 10 degrees about something half a metre away.
Rigid3 Turn() {
  Rigid3 pose;
  pose.rotation = Eigen::AngleAxisd(0.17, Eigen::Vector3d(0.1, 0.97, 0.2).normalized()).toRotationMatrix();
  pose.translation = Eigen::Vector3d(-0.95, 0.1, 0.08).normalized();
  return pose;
}

/// Pairs of points at depths of 4 to 8 baselines; with `plane_share`, that many of 1 lie in one plane.
std::vector<PointPair> DrawPairs(int count, double plane_share, double noise, SceneRandom& random) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d first(random.Uniform(-0.3, 0.3), random.Uniform(-0.2, 0.2));
    const bool in_plane = i < plane_share * count;
    const double depth = in_plane ? 6 / (1 + 0.5 * first.x() + 1.2 * first.y()) : random.Uniform(4, 8);
    const Eigen::Vector3d second = Turn() * Eigen::Vector3d(depth * first.homogeneous());
    const Eigen::Vector2d shake(random.Uniform(-noise, noise), random.Uniform(-noise, noise));
    pairs.push_back({first, second.hnormalized() + shake});
  }
  return pairs;
}

double RotationError(const Rigid3& a, const Rigid3& b) {
  return Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle();
}

TEST(FivePointTest, OneOfTheSolutionsIsTheTruth) {
  SceneRandom random(3);
  const Eigen::Matrix3d truth = EssentialFromPose(Turn()).normalized();
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<PointPair> pairs = DrawPairs(5, 0, 0, random);
    std::array<PointPair, 5> sample;
    std::copy(pairs.begin(), pairs.end(), sample.begin());
    double best = 1;
    for (const Eigen::Matrix3d& e : SolveFivePoint(sample)) {
      best = std::min({best, (e - truth).norm(), (e + truth).norm()});
    }
    EXPECT_LT(best, 1e-5);
  }
}

TEST(FivePointTest, SolutionsAreEssentialAndFitTheSample) {
  SceneRandom random(4);
  const std::vector<PointPair> pairs = DrawPairs(5, 0, 0.01, random);
  std::array<PointPair, 5> sample;
  std::copy(pairs.begin(), pairs.end(), sample.begin());
  const std::vector<Eigen::Matrix3d> solutions = SolveFivePoint(sample);
  ASSERT_FALSE(solutions.empty());
  for (const Eigen::Matrix3d& e : solutions) {
    EXPECT_NEAR(e.determinant(), 0, 1e-8);
    EXPECT_LT((2 * e * e.transpose() * e - (e * e.transpose()).trace() * e).norm(), 1e-7);
    for (const PointPair& pair : sample)
      EXPECT_NEAR(pair.second.homogeneous().dot(e * pair.first.homogeneous()), 0, 1e-9);
  }
}

TEST(FivePointTest, RepeatedPointsGiveNoNonsense) {
  std::array<PointPair, 5> sample;
  sample.fill({{0.1, 0.2}, {0.12, 0.2}});
  for (const Eigen::Matrix3d& e : SolveFivePoint(sample)) EXPECT_TRUE(e.allFinite());
}

TEST(RelativePoseTest, SurvivesHalfOutliers) {
  SceneRandom random(5);
  std::vector<PointPair> pairs = DrawPairs(300, 0, 2e-4, random);
  for (int i = 0; i < 150; ++i) pairs[i].second = {random.Uniform(-0.3, 0.3), random.Uniform(-0.2, 0.2)};
  const auto pose = EstimateRelativePose(pairs, {1e-3, 0.9999, 2000, 1});
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT(RotationError(pose->second_from_first, Turn()), 2e-3);
  EXPECT_LT((pose->second_from_first.translation - Turn().translation).norm(), 1e-2);
  const auto right = std::count_if(pose->inliers.begin(), pose->inliers.end(), [](int i) { return i >= 150; });
  EXPECT_GT(right, 140);
  EXPECT_LT(static_cast<int>(pose->inliers.size()) - right, 10);
}

TEST(RelativePoseTest, IsTheSameForTheSameSeed) {
  SceneRandom random(6);
  const std::vector<PointPair> pairs = DrawPairs(80, 0, 1e-3, random);
  const RansacOptions options{1e-3, 0.99, 500, 42};
  const auto a = EstimateRelativePose(pairs, options), b = EstimateRelativePose(pairs, options);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->inliers, b->inliers);
  EXPECT_EQ(a->second_from_first.rotation, b->second_from_first.rotation);
}

TEST(RelativePoseTest, SamplesNoMoreThanAnUsefulModelNeeds) {
  RansacOptions options{1e-3, 0.9999, 2'000, 1};
  EXPECT_EQ(MostIterations(40, 5, options), 2'000);
  options.min_inliers = 20;
  EXPECT_NEAR(MostIterations(40, 5, options), std::log(1e-4) / std::log1p(-1.0 / 32), 1e-9);
  EXPECT_EQ(MostIterations(400, 5, options), 2'000);
  EXPECT_LE(MostIterations(20, 5, options), 1);
}

TEST(RelativePoseTest, FindsAPoseOfJustEnoughInliers) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SceneRandom random(seed);
    std::vector<PointPair> pairs = DrawPairs(20, 0, 1e-5, random);
    for (PointPair& wrong : DrawPairs(25, 0, 0, random)) {
      pairs.push_back({wrong.first, {random.Uniform(-0.3, 0.3), random.Uniform(-0.3, 0.3)}});
    }
    const auto pose = EstimateRelativePose(pairs, {1e-4, 0.9999, 2'000, seed, 20});
    ASSERT_TRUE(pose.has_value());
    EXPECT_GE(pose->inliers.size(), 20u) << seed;
    EXPECT_LT(RotationError(pose->second_from_first, Turn()), 1e-3) << seed;
  }
}

TEST(RelativePoseTest, NeedsFivePairs) {
  SceneRandom random(7);
  EXPECT_FALSE(EstimateRelativePose(DrawPairs(4, 0, 0, random), {1e-3, 0.99, 100, 1}).has_value());
}

TEST(HomographyTest, ShareTellsAPlaneFromASolid) {
  SceneRandom random(8);
  const auto plane = EstimateHomography(DrawPairs(200, 1, 1e-4, random), 1e-3, 1);
  const auto mixed = EstimateHomography(DrawPairs(200, 0.7, 1e-4, random), 1e-3, 1);
  const auto solid = EstimateHomography(DrawPairs(200, 0, 1e-4, random), 1e-3, 1);
  ASSERT_TRUE(plane && mixed && solid);
  EXPECT_GT(plane->inlier_share, 0.99);
  EXPECT_NEAR(mixed->inlier_share, 0.72, 0.06);
  EXPECT_LT(solid->inlier_share, 0.3);
  EXPECT_FALSE(EstimateHomography(DrawPairs(3, 0, 0, random), 1e-3, 1).has_value());
}

TEST(HomographyTest, OneOfThePlanesPosesIsTheTruth) {
  SceneRandom random(9);
  const auto plane = EstimateHomography(DrawPairs(100, 1, 0, random), 1e-6, 1);
  ASSERT_TRUE(plane.has_value());
  const std::vector<Rigid3> poses = PosesFromHomography(plane->matrix);
  ASSERT_EQ(poses.size(), 2u);
  double best = 1;
  for (const Rigid3& pose : poses) {
    EXPECT_NEAR(pose.rotation.determinant(), 1, 1e-9);
    const double along = std::abs(pose.translation.dot(Turn().translation));
    best = std::min(best, RotationError(pose, Turn()) + (1 - along));
  }
  EXPECT_LT(best, 1e-6);
}

TEST(HomographyTest, PureTurnHasNoTranslation) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_TRUE(PosesFromHomography(3 * turn).empty());
}

}  // namespace
}  // namespace drupe
