#include "reconstruction/dense/poisson_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace drupe {
namespace {

/// A ball of radius 10 without the points below z = -7, which no camera sees.
PointCloud OpenBall() {
  constexpr int kCount = 5'000;
  PointCloud cloud;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - 2 * (i + 0.5) / kCount, turn = 2.399963 * i, r = std::sqrt(1 - z * z);
    if (z < -0.7) continue;
    cloud.normals.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    cloud.positions.push_back(10 * cloud.normals.back());
  }
  return cloud;
}

TEST(PoissonMesh, ClosesTheSurface) {
  const Result<TriangleMesh> mesh = BuildPoissonMesh(OpenBall(), {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  EXPECT_TRUE(mesh->IsClosed());
  EXPECT_NEAR(mesh->Volume() / (4.0 / 3 * std::numbers::pi * 1000), 1, 0.01);
  EXPECT_NEAR(mesh->Area() / (4 * std::numbers::pi * 100), 1, 0.01);
}

TEST(PoissonMesh, IsTheSameEveryTime) {
  const Result<TriangleMesh> one = BuildPoissonMesh(OpenBall(), {}), two = BuildPoissonMesh(OpenBall(), {});
  ASSERT_TRUE(one.ok() && two.ok());
  EXPECT_TRUE(WritePlyMesh(*one) == WritePlyMesh(*two));
}

TEST(PoissonMesh, SaysWhyThereIsNone) {
  PointCloud cloud = OpenBall();
  cloud.normals.clear();
  EXPECT_EQ(BuildPoissonMesh(cloud, {}).status().code(), "no_mesh");
  EXPECT_EQ(BuildPoissonMesh(PointCloud(), {}).status().code(), "no_mesh");
  RunContext context;
  context.cancelled = [] { return true; };
  EXPECT_EQ(BuildPoissonMesh(OpenBall(), context).status().kind(), StatusKind::kCancelled);
}

TEST(TriangleMesh, KnowsVolumeAreaAndHoles) {
  TriangleMesh corner;
  corner.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  corner.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  EXPECT_NEAR(corner.Volume(), 1.0 / 6, 1e-9);
  EXPECT_NEAR(corner.Area(), 1.5 + std::sqrt(3.0) / 2, 1e-6);
  EXPECT_TRUE(corner.IsClosed());
  EXPECT_NE(WritePlyMesh(corner).find("element face 4"), std::string::npos);
  corner.triangles.pop_back();
  EXPECT_FALSE(corner.IsClosed());
}

}  // namespace
}  // namespace drupe
