#include "reconstruction/dense/smooth_normals.h"

#include <gtest/gtest.h>

#include <cmath>

namespace drupe::dense {
namespace {

/// Points about a quarter of a unit apart on the upper part of a ball of radius 10 about (40, -50, 30), cut off at its
/// rim.
std::vector<Eigen::Vector3f> Cap() {
  std::vector<Eigen::Vector3f> positions;
  for (int y = -28; y <= 28; ++y) {
    for (int x = -28; x <= 28; ++x) {
      const float rim2 = 100 - 0.0625f * static_cast<float>(x * x + y * y);
      if (rim2 < 50) continue;
      positions.emplace_back(40 + 0.25f * x, -50 + 0.25f * y, 30 + std::sqrt(rim2));
    }
  }
  return positions;
}

Eigen::Vector3f TrueNormal(const Eigen::Vector3f& position) {
  return (position - Eigen::Vector3f(40, -50, 30)).normalized();
}

TEST(SmoothNormals, TakeAPointsNoiseOutAsFarAsTheRim) {
  const std::vector<Eigen::Vector3f> positions = Cap();
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto turn = static_cast<float>(i * 2.4);
    const Eigen::Vector3f noise(std::cos(turn), std::sin(turn), 0);
    normals.push_back((TrueNormal(positions[i]) + 0.3f * noise).normalized());
  }
  const SurfaceGrid grid(positions, 2);
  const SmoothNormals smooth(grid, positions, normals);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Eigen::Vector3f normal = smooth.At(grid.At(positions[i]), positions[i], normals[i]);
    EXPECT_NEAR(normal.norm(), 1, 1e-5);
    EXPECT_LT((normal - TrueNormal(positions[i])).norm(), 0.09f);
  }
}

TEST(SmoothNormals, AreThoseOfABallWhereThereIsNoNoise) {
  const std::vector<Eigen::Vector3f> positions = Cap();
  std::vector<Eigen::Vector3f> normals;
  for (const Eigen::Vector3f& position : positions) normals.push_back(TrueNormal(position));
  const SurfaceGrid grid(positions, 2);
  const SmoothNormals smooth(grid, positions, normals);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    EXPECT_LT((smooth.At(grid.At(positions[i]), positions[i], normals[i]) - normals[i]).norm(), 1e-4f);
  }
}

TEST(SmoothNormals, KeepTheOwnOneOfAThinThingsOtherSide) {
  const std::vector<Eigen::Vector3f> positions = {{0, 0, 0}, {0.2f, 0, 0}, {0, 0.2f, 0}, {0, 0, 0.5f}};
  const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  const std::vector<Eigen::Vector3f> normals = {up, up, up, -up};
  const SurfaceGrid grid(positions, 2);
  const SmoothNormals smooth(grid, positions, normals);
  EXPECT_EQ(smooth.At(grid.At(positions[3]), positions[3], normals[3]), -up);
}

TEST(SmoothNormals, OfASinglePointAreItsOwn) {
  const std::vector<Eigen::Vector3f> positions = {{3, 4, 5}}, normals = {Eigen::Vector3f(0, 0.6f, 0.8f)};
  const SurfaceGrid grid(positions, 2);
  const SmoothNormals smooth(grid, positions, normals);
  EXPECT_LT((smooth.At(grid.At(positions[0]), positions[0], normals[0]) - normals[0]).norm(), 1e-5f);
}

}  // namespace
}  // namespace drupe::dense
