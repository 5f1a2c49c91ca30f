#include "reconstruction/sparse/robust_sim3.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace drupe {
namespace {

const Sim3 kTruth{2.5, Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix(),
                  Eigen::Vector3d(10, -4, 7)};

/// Pairs with noise of a tenth of the tolerance, of which `wrong_share` are anywhere.
std::vector<FramePair> Pairs(int count, double wrong_share) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 0.01);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<FramePair> pairs;
  for (int i = 0; i < count; ++i) {
    const auto any = [&] { return Eigen::Vector3d(uniform(random), uniform(random), uniform(random)); };
    const Eigen::Vector3d from = 5 * any();
    const Eigen::Vector3d off(noise(random), noise(random), noise(random));
    const bool is_wrong = i < wrong_share * count;
    pairs.push_back({from, is_wrong ? Eigen::Vector3d(30 * any()) : Eigen::Vector3d(kTruth * from + off), 0.1});
  }
  return pairs;
}

TEST(RobustSim3Test, FindsTheSimilarityAmongOutliers) {
  for (const double wrong_share : {0.0, 0.3, 0.6}) {
    const auto estimate = EstimateSim3(Pairs(200, wrong_share), 1);
    ASSERT_TRUE(estimate.has_value()) << wrong_share;
    EXPECT_NEAR(estimate->to_from.scale, kTruth.scale, 2e-3);
    EXPECT_LT((estimate->to_from.rotation - kTruth.rotation).norm(), 2e-3);
    EXPECT_LT((estimate->to_from.translation - kTruth.translation).norm(), 0.01);
    EXPECT_NEAR(estimate->inlier_count, 200 * (1 - wrong_share), 2);
    EXPECT_EQ(estimate->is_inlier.size(), 200u);
  }
}

TEST(RobustSim3Test, GivesNothingWhereNothingAgrees) {
  EXPECT_FALSE(EstimateSim3(Pairs(2, 0), 1).has_value());
  EXPECT_FALSE(EstimateSim3(Pairs(40, 1), 1).has_value());
  const std::vector<FramePair> line = {
      {{0, 0, 0}, {0, 0, 0}, 0.1}, {{1, 0, 0}, {2, 0, 0}, 0.1}, {{2, 0, 0}, {4, 0, 0}, 0.1}};
  EXPECT_FALSE(EstimateSim3(line, 1).has_value());
}

TEST(RobustSim3Test, ASeedGivesOneResult) {
  const std::vector<FramePair> pairs = Pairs(100, 0.4);
  EXPECT_EQ(EstimateSim3(pairs, 9)->to_from.translation, EstimateSim3(pairs, 9)->to_from.translation);
}

}  // namespace
}  // namespace drupe
