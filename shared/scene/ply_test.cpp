#include "scene/ply.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace drupe {
namespace {

PointCloud TwoPoints() {
  PointCloud cloud;
  cloud.positions = {{1, 2, 3}, {-4, 5.5f, 6}};
  cloud.normals = {{0, 0, 1}, {0, 1, 0}};
  cloud.colours = {{10, 20, 30}, {255, 0, 128}};
  cloud.raw_colours = {{11, 22, 33}, {0, 255, 127}};
  cloud.view_counts = {3, 9};
  cloud.ncc = {0.75f, 0.5f};
  cloud.expected_error = {0.01f, 0.02f};
  return cloud;
}

std::string Header(const std::string& body) {
  return "ply\nformat binary_little_endian 1.0\n" + body + "end_header\n";
}

const char kXyz[] = "property float x\nproperty float y\nproperty float z\n";

TEST(PlyTest, KeepsEveryAttribute) {
  const PointCloud cloud = TwoPoints();
  const Result<PointCloud> read = ReadPly(WritePly(cloud));
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->positions, cloud.positions);
  EXPECT_EQ(read->normals, cloud.normals);
  EXPECT_EQ(read->colours, cloud.colours);
  EXPECT_EQ(read->raw_colours, cloud.raw_colours);
  EXPECT_EQ(read->view_counts, cloud.view_counts);
  EXPECT_EQ(read->ncc, cloud.ncc);
  EXPECT_EQ(read->expected_error, cloud.expected_error);
}

TEST(PlyTest, LeavesUnknownAttributesEmpty) {
  PointCloud cloud;
  cloud.positions = {{1, 2, 3}};
  const Result<PointCloud> read = ReadPly(WritePly(cloud));
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->size(), 1u);
  EXPECT_TRUE(read->normals.empty());
  EXPECT_TRUE(read->colours.empty());
  EXPECT_TRUE(read->ncc.empty());
}

TEST(PlyTest, SkipsOtherPropertiesAndElements) {
  const double xyz[3] = {1, 2, 3};
  std::string file = Header(
      "comment any\nelement vertex 1\nproperty uchar label\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar int vertex_indices\n");
  file += '\7';
  file.append(reinterpret_cast<const char*>(xyz), sizeof xyz);
  file += std::string(13, '\0');
  const Result<PointCloud> read = ReadPly(file);
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->positions[0], Eigen::Vector3f(1, 2, 3));
}

TEST(PlyTest, RefusesHostileFiles) {
  const auto code = [](const std::string& file) { return ReadPly(file).status().code(); };
  const std::string vertex = std::string("element vertex 1\n") + kXyz;
  EXPECT_EQ(code(""), "bad_ply");
  EXPECT_EQ(code("ply\n"), "bad_ply");
  EXPECT_EQ(code("plywood\n"), "bad_ply");
  EXPECT_EQ(code("ply\nformat ascii 1.0\nend_header\n"), "unsupported_ply");
  EXPECT_EQ(code("ply\nformat binary_big_endian 1.0\nend_header\n"), "unsupported_ply");
  EXPECT_EQ(code("ply\nelement vertex 0\nend_header\n"), "bad_ply");
  EXPECT_EQ(code(Header("")), "bad_ply");
  EXPECT_EQ(code(Header("element face 1\n" + vertex)), "bad_ply");
  EXPECT_EQ(code(Header("element vertex -1\n")), "bad_ply");
  EXPECT_EQ(code(Header("element vertex 1x\n")), "bad_ply");
  EXPECT_EQ(code(Header("element vertex 99999999999999999999\n")), "bad_ply");
  EXPECT_EQ(code(Header("element vertex 9223372036854775807\n")), "ply_too_large");
  EXPECT_EQ(code(Header(std::string("element vertex 40000000\n") + kXyz)), "bad_ply");
  EXPECT_EQ(code(Header("element vertex 1\nproperty list uchar float x\n")), "bad_ply");
  EXPECT_EQ(code(Header("element vertex 1\nproperty quad x\n")), "bad_ply");
  EXPECT_EQ(code(Header("element vertex 0\nproperty float x\n")), "bad_ply");
  EXPECT_EQ(code(Header(vertex) + std::string(11, '\0')), "bad_ply");
  EXPECT_EQ(code("ply\n" + std::string(200'000, 'c')), "bad_ply");
}

TEST(PlyTest, RefusesPositionsThatAreNoNumbers) {
  PointCloud cloud;
  cloud.positions = {{1, std::numeric_limits<float>::quiet_NaN(), 3}};
  EXPECT_EQ(ReadPly(WritePly(cloud)).status().code(), "bad_ply");
  cloud.positions = {{1, std::numeric_limits<float>::infinity(), 3}};
  EXPECT_EQ(ReadPly(WritePly(cloud)).status().code(), "bad_ply");
}

TEST(PlyTest, ObeysTheLimit) {
  PlyLimits limits;
  limits.max_points = 1;
  EXPECT_EQ(ReadPly(WritePly(TwoPoints()), limits).status().code(), "ply_too_large");
}

}  // namespace
}  // namespace drupe
