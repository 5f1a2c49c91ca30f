#include "reconstruction/dense/unseen_side.h"

#include <gtest/gtest.h>

#include <cmath>

namespace drupe::dense {
namespace {

const Eigen::Vector3f kMiddle(3, -2, 30);
constexpr float kCutRadius = 10;

/// Points on a ball about `middle`, without those below `lowest` radii.
PointCloud Ball(const Eigen::Vector3f& middle, double lowest) {
  constexpr int kCount = 60'000;
  PointCloud cloud;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kCount, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
    if (z < lowest) continue;
    cloud.normals.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    cloud.positions.push_back(middle + kCutRadius * cloud.normals.back());
  }
  return cloud;
}

TEST(GuessUnseenSide, ContinuesTheSkin) {
  const PointCloud guessed = GuessUnseenSide(Ball(kMiddle, -0.6));
  ASSERT_GT(guessed.size(), 1000u);
  ASSERT_EQ(guessed.normals.size(), guessed.size());
  float lowest = 1;
  for (std::size_t i = 0; i < guessed.size(); ++i) {
    const Eigen::Vector3f out = guessed.positions[i] - kMiddle;
    ASSERT_NEAR(out.norm(), kCutRadius, 0.05f);
    ASSERT_GT(guessed.normals[i].dot(out.normalized()), 0.999f);
    ASSERT_LT(out.z(), -0.6f * kCutRadius);
    lowest = std::min(lowest, out.z() / kCutRadius);
  }
  EXPECT_LT(lowest, -0.99f);
}

TEST(GuessUnseenSide, IsNotBentByAFewWrongPointsBeyondTheSeen) {
  PointCloud cloud = Ball(kMiddle, -0.5);
  for (int i = 0; i < 60; ++i) {
    const double turn = 0.4 + 0.01 * i, z = -0.7, r = std::sqrt(1 - z * z);
    cloud.normals.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    cloud.positions.push_back(kMiddle + 0.93f * kCutRadius * cloud.normals.back());
  }
  const PointCloud guessed = GuessUnseenSide(cloud);
  ASSERT_GT(guessed.size(), 1000u);
  for (const Eigen::Vector3f& position : guessed.positions) ASSERT_NEAR((position - kMiddle).norm(), kCutRadius, 0.1f);
}

TEST(GuessUnseenSide, AddsNothingWhereItCannotKnow) {
  EXPECT_TRUE(GuessUnseenSide(PointCloud()).empty());
  EXPECT_TRUE(GuessUnseenSide(Ball(kMiddle, -1)).empty());  // all of it was seen
  PointCloud two = Ball(kMiddle, -0.6);
  const PointCloud other = Ball(kMiddle + Eigen::Vector3f(25, 0, 0), -0.6);
  two.positions.insert(two.positions.end(), other.positions.begin(), other.positions.end());
  two.normals.insert(two.normals.end(), other.normals.begin(), other.normals.end());
  EXPECT_TRUE(GuessUnseenSide(two).empty());
}

}  // namespace
}  // namespace drupe::dense
