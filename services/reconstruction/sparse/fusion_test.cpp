#include "reconstruction/sparse/fusion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "reconstruction/sparse/synthetic_scene.h"
#include "reconstruction/sparse/track_triangulation.h"

namespace drupe {
namespace {

/// What cluster `c` would find: the truth in a frame and scale of its own.
ClusterModel TrueModel(const SyntheticScene& scene, const SfmState& whole, int c) {
  ClusterModel model = RestrictTo(whole, kArcs[c]);
  const Eigen::Vector3d axis = Eigen::Vector3d(1, c, -2).normalized();
  const Sim3 own{0.3 + 0.4 * c, Eigen::AngleAxisd(0.7 * c, axis).toRotationMatrix(), Eigen::Vector3d(c, 5, -c)};
  for (const int v : kArcs[c]) model.state.poses[v] = TransformPose(scene.poses[v], own);
  EXPECT_TRUE(UpdateTracks(model.state, TriangulationOptions{}, RunContext{}).ok());
  return model;
}

/// Moves every fifth track of a model somewhere else, as wrong matches do.
void Spoil(ClusterModel& model) {
  for (std::size_t t = 0; t < model.state.tracks.size(); t += 5) {
    model.state.tracks[t].position += Eigen::Vector3d(30, static_cast<double>(t % 7), -20);
  }
}

double MeanCentreError(const SyntheticScene& scene, const SfmState& state) {
  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t v = 0; v < scene.poses.size(); ++v) {
    if (!state.poses[v]) continue;
    from.push_back(state.poses[v]->Centre());
    to.push_back(scene.poses[v].Centre());
  }
  const auto fit = FitSim3(from, to);
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (*fit * from[i] - to[i]).norm();
  return sum / static_cast<double>(from.size());
}

class FusionTest : public testing::Test {
 protected:
  FusionTest() : whole_(MakeSfmState(scene_.Input(true))) {
    for (int c = 0; c < 4; ++c) models_.push_back(TrueModel(scene_, whole_, c));
  }
  SyntheticScene scene_;
  SfmState whole_;
  std::vector<ClusterModel> models_;
};

TEST_F(FusionTest, BringsModelsOfAnyFrameTogetherDespiteWrongTracks) {
  for (ClusterModel& model : models_) Spoil(model);
  ASSERT_TRUE(FuseClusters(models_, SparseOptions{}, RunContext{}, whole_));
  EXPECT_EQ(whole_.RegisteredCount(), 24);
  EXPECT_LT(MeanCentreError(scene_, whole_), 0.1);
  EXPECT_FALSE(whole_.is_metric);
}

TEST_F(FusionTest, LinksCarryTheTrueSimilarity) {
  const std::vector<ClusterLink> links = LinkClusters(models_, SparseOptions{}, RunContext{});
  EXPECT_GE(links.size(), 4u);  // the ring closes
  for (const ClusterLink& link : links) {
    EXPECT_LT(link.first, link.second);
    EXPECT_NEAR(link.second_from_first.scale, (0.3 + 0.4 * link.second) / (0.3 + 0.4 * link.first), 0.01);
  }
}

TEST_F(FusionTest, TheBoardsFrameNeedsNoLink) {
  models_[2] = RestrictTo(whole_, kArcs[2]);
  for (const int v : kArcs[2]) models_[2].state.poses[v] = scene_.poses[v];
  models_[2].state.is_metric = true;
  EXPECT_TRUE(UpdateTracks(models_[2].state, TriangulationOptions{}, RunContext{}).ok());
  ASSERT_TRUE(FuseClusters(models_, SparseOptions{}, RunContext{}, whole_));
  EXPECT_TRUE(whole_.is_metric);
  EXPECT_LT((whole_.poses[15]->translation - scene_.poses[15].translation).norm(), 1e-9);
  EXPECT_LT((whole_.poses[3]->Centre() - scene_.poses[3].Centre()).norm(), 1.0);
}

TEST_F(FusionTest, AClusterThatNothingReachesIsLeftOut) {
  for (SfmTrack& track : models_[1].state.tracks) track.has_position = false;
  ASSERT_TRUE(FuseClusters(models_, SparseOptions{}, RunContext{}, whole_));
  EXPECT_FALSE(whole_.poses[9].has_value());
  EXPECT_TRUE(whole_.poses[21].has_value());
  EXPECT_FALSE(FuseClusters({}, SparseOptions{}, RunContext{}, whole_));
}

}  // namespace
}  // namespace drupe
