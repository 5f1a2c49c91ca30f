#include <gtest/gtest.h>

#include "base/files.h"
#include "cli/bench/dense_truth.h"
#include "scene/ply.h"

namespace drupe {
namespace {

const TruthSet& Sample() {
  static const TruthSet set = LoadTruthSet(std::string(DRUPE_TEST_DATA) + "/plum-s").value();
  return set;
}

/// The true skin itself as a cloud, every point `off` mm further out.
PointCloud Skin(double off, float expected) {
  PointCloud cloud = ReadPly(ReadFile(Sample().directory + "/surface.ply", 1 << 28).value()).value();
  Eigen::Vector3f centre;
  for (int axis = 0; axis < 3; ++axis) centre[axis] = Sample().truth["centre_mm"][axis].get<float>();
  for (Eigen::Vector3f& position : cloud.positions) {
    position += static_cast<float>(off) * (position - centre).normalized();
  }
  cloud.expected_error.assign(cloud.size(), expected);
  return cloud;
}

TEST(CompareCloud, TheTruthItselfIsCompleteAndExact) {
  const Result<DenseErrors> errors = CompareCloud(Sample(), Skin(0, 0.01f), Sim3());
  ASSERT_TRUE(errors.ok()) << errors.status().message();
  EXPECT_EQ(errors->on_fruit, errors->points);
  EXPECT_LT(errors->median, 1e-4);
  EXPECT_EQ(errors->complete_010_pct, 100);
  EXPECT_EQ(errors->visible_020_pct, 100);
}

TEST(CompareCloud, MeasuresAnOffsetAlsoThroughASimilarity) {
  PointCloud cloud = Skin(0.05, 0.1f);
  const Sim3 truth_from_cloud{2, Eigen::Matrix3d::Identity(), Eigen::Vector3d(1, 2, 3)};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.positions[i] = (truth_from_cloud.Inverse() * cloud.positions[i].cast<double>()).cast<float>();
    cloud.expected_error[i] /= 2;
  }
  const Result<DenseErrors> errors = CompareCloud(Sample(), cloud, truth_from_cloud);
  ASSERT_TRUE(errors.ok());
  EXPECT_NEAR(errors->median, 0.05, 2e-3);
  EXPECT_NEAR(errors->error_over_expected, 0.5, 0.03);
  EXPECT_EQ(errors->over_03_pct, 0);
}

TEST(CompareCloud, SeesWhatIsMissing) {
  PointCloud cloud = Skin(0, 0.01f);
  const std::size_t all = cloud.size();
  std::erase_if(cloud.positions, [](const Eigen::Vector3f& position) { return position.x() > 0.9f; });
  cloud.expected_error.clear();
  const Result<DenseErrors> errors = CompareCloud(Sample(), cloud, Sim3());
  ASSERT_TRUE(errors.ok());
  EXPECT_LT(errors->points, all * 6 / 10);
  EXPECT_NEAR(errors->complete_010_pct, 50, 5);
  EXPECT_EQ(errors->error_over_expected, 0);
}

}  // namespace
}  // namespace drupe
