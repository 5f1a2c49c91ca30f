#include "reconstruction/dense/preview.h"

#include <gtest/gtest.h>

#include <cmath>

#include "scene/ply.h"

namespace drupe {
namespace {

/// Points all over a ball of radius 10, evenly (a Fibonacci spiral).
PointCloud Ball(int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
    cloud.normals.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    cloud.positions.push_back(10 * cloud.normals.back());
    cloud.colours.emplace_back(z > 0 ? 200 : 100, 50, 0);
    cloud.raw_colours.emplace_back(7, 8, 9);
    cloud.view_counts.push_back(5);
    cloud.ncc.push_back(0.75f);
    cloud.expected_error.push_back(0.01f);
  }
  return cloud;
}

TEST(DecimateCloud, KeepsShapeAndColoursInAboutTheNumberAskedFor) {
  const PointCloud small = DecimateCloud(Ball(60'000), 5'000);
  EXPECT_NEAR(static_cast<double>(small.size()), 5'000, 500);
  ASSERT_EQ(small.normals.size(), small.size());
  for (std::size_t i = 0; i < small.size(); ++i) {
    EXPECT_NEAR(small.positions[i].norm(), 10, 0.05);
    EXPECT_NEAR(small.normals[i].norm(), 1, 1e-5);
    EXPECT_GT(small.normals[i].dot(small.positions[i].normalized()), 0.99f);
    if (small.positions[i].z() > 1) {
      EXPECT_EQ(small.colours[i], (Eigen::Matrix<std::uint8_t, 3, 1>(200, 50, 0)));
    }
    EXPECT_EQ(small.raw_colours[i][2], 9);
    EXPECT_EQ(small.view_counts[i], 5);
    EXPECT_NEAR(small.ncc[i], 0.75f, 1e-6);
  }
}

TEST(DecimateCloud, IsTheSameEveryTime) {
  EXPECT_TRUE(WritePly(DecimateCloud(Ball(20'000), 1'000)) == WritePly(DecimateCloud(Ball(20'000), 1'000)));
}

TEST(DecimateCloud, LeavesSmallCloudsAlone) {
  EXPECT_EQ(DecimateCloud(Ball(100), 100).size(), 100u);
  EXPECT_TRUE(DecimateCloud(PointCloud(), 100).empty());
  PointCloud bare;
  bare.positions.assign(50, Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(DecimateCloud(bare, 10).size(), 1u);  // all in one place
}

}  // namespace
}  // namespace drupe
