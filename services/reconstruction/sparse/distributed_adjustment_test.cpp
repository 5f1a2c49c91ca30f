#include "reconstruction/sparse/distributed_adjustment.h"

#include <gtest/gtest.h>

#include "reconstruction/sparse/adjustment_layout.h"
#include "reconstruction/sparse/linearised_observation.h"
#include "reconstruction/sparse/monolithic_adjustment.h"
#include "reconstruction/sparse/synthetic_scene.h"
#include "reconstruction/sparse/track_triangulation.h"
#include "reconstruction/sparse/uncertainty.h"

namespace drupe {
namespace {

/// Arcs of eight views of a ring of 24, each of which shares two with the next.
/// The ring with poses a little off the truth and tracks triangulated from them.
SfmState Disturbed(const SyntheticScene& scene, bool is_metric) {
  SfmState state = MakeSfmState(scene.Input(is_metric));
  for (int v = 0; v < state.ViewCount(); ++v) {
    PoseStep step = PoseStep::Zero();
    for (int k = 0; k < 3; ++k) step[k] = 2e-4 * std::sin(7 * v + k), step[k + 3] = 0.05 * std::cos(5 * v + k);
    state.poses[v] = ApplyStep(scene.poses[v], step);
  }
  state.is_metric = is_metric;
  EXPECT_TRUE(UpdateTracks(state, TriangulationOptions{}, RunContext{}).ok());
  return state;
}

AdjustmentOptions Thorough() {
  AdjustmentOptions options;
  options.max_iterations = 50;
  options.function_tolerance = 1e-9;
  return options;
}

TEST(DistributedAdjustmentTest, ReachesTheCostOfTheUndividedProblem) {
  for (const bool is_metric : {true, false}) {
    const SyntheticScene scene;
    SfmState distributed = Disturbed(scene, is_metric);
    ShareByCluster(kArcs, distributed);
    SfmState monolithic = distributed;
    const double before = AdjustmentCost(distributed, Thorough());
    const AdjustmentScope all = AdjustmentScope::Everything(distributed);
    ASSERT_TRUE(AdjustDistributed(distributed, all, Thorough(), RunContext{}).ok());
    ASSERT_TRUE(AdjustMonolithic(monolithic, all, Thorough(), RunContext{}).ok());
    const double cost = AdjustmentCost(distributed, Thorough()), expected = AdjustmentCost(monolithic, Thorough());
    EXPECT_LT(expected, 0.9 * before);
    EXPECT_NEAR(cost, expected, 1e-3 * expected) << (is_metric ? "with" : "without") << " a board";
    EXPECT_NEAR(distributed.ink_spread_mm, monolithic.ink_spread_mm, 1e-4);
  }
}

TEST(DistributedAdjustmentTest, ReachesItWithManyViews) {
  SyntheticScene::Options options;
  options.views = 120, options.points = 250;
  SfmState distributed = Disturbed(SyntheticScene(options), true);
  ShareByOrder(10, distributed);
  SfmState monolithic = distributed;
  const AdjustmentScope all = AdjustmentScope::Everything(distributed);
  ASSERT_TRUE(AdjustDistributed(distributed, all, Thorough(), RunContext{}).ok());
  ASSERT_TRUE(AdjustMonolithic(monolithic, all, Thorough(), RunContext{}).ok());
  const double expected = AdjustmentCost(monolithic, Thorough());
  EXPECT_NEAR(AdjustmentCost(distributed, Thorough()), expected, 1e-3 * expected);
}

TEST(DistributedAdjustmentTest, EndsWhenThePosesHaveStoppedMoving) {
  SyntheticScene::Options scene;
  scene.wrong_share = 0.1;
  const SfmState start = Disturbed(SyntheticScene(scene), true);
  const auto adjust = [&start](double tolerance, SfmState& state, int& looks) {
    state = start;
    ShareByCluster(kArcs, state);
    AdjustmentOptions options = Thorough();
    options.pose_tolerance_sigmas = tolerance;
    RunContext context;
    context.threads = 1;
    context.cancelled = [&looks] { return ++looks < 0; };  // asked a fixed number of times an iteration
    return AdjustDistributed(state, AdjustmentScope::Everything(state), options, context);
  };
  SfmState thorough, early;
  int looks = 0, early_looks = 0;
  ASSERT_TRUE(adjust(0, thorough, looks).ok());
  ASSERT_TRUE(adjust(0.003, early, early_looks).ok());
  EXPECT_LT(early_looks, 0.7 * looks);
  const auto uncertainty = EstimateUncertainty(thorough, EstimateNoise(thorough), Thorough(), RunContext{});
  ASSERT_TRUE(uncertainty.ok());
  for (int v = 0; v < start.ViewCount(); ++v) {
    const double moved = (early.poses[v]->Centre() - thorough.poses[v]->Centre()).norm();
    EXPECT_LT(moved, 0.1 * uncertainty->centre_sigma[v]) << v;
  }
}

TEST(DistributedAdjustmentTest, OneShareAloneGoesOnAsFar) {
  SfmState early = Disturbed(SyntheticScene{}, false);
  ShareByOrder(1, early);  // no view is shared, and nothing else is
  SfmState thorough = early;
  const AdjustmentScope all = AdjustmentScope::Everything(early);
  AdjustmentOptions options = Thorough();
  ASSERT_TRUE(AdjustDistributed(thorough, all, options, RunContext{}).ok());
  options.pose_tolerance_sigmas = 0.003;
  ASSERT_TRUE(AdjustDistributed(early, all, options, RunContext{}).ok());
  EXPECT_NEAR(AdjustmentCost(early, options) / AdjustmentCost(thorough, options), 1, 1e-3);
}

TEST(DistributedAdjustmentTest, SharesKeepTheirInnerViewsToThemselves) {
  SfmState state = Disturbed(SyntheticScene{}, true);
  // Without what reaches from arc to arc, the views between the shared ones are nobody else's.
  ShareByCluster(kArcs, state);
  for (SfmObservation& o : state.observations) {
    const std::vector<int>& arc = kArcs[state.tracks[o.track].share];
    o.is_active = o.is_active && std::binary_search(arc.begin(), arc.end(), o.view);
  }
  const AdjustmentLayout layout = LayOut(state, AdjustmentScope::Everything(state), false);
  ASSERT_EQ(layout.shares.size(), 4u);
  EXPECT_EQ(layout.shared_views, (std::vector<int>{0, 1, 6, 7, 12, 13, 18, 19}));
  std::vector<int> holders(state.ViewCount(), 0);
  for (const TrackShare& share : layout.shares) {
    EXPECT_EQ(share.inner_count, 4);
    for (const int v : share.board_views) ++holders[v];
  }
  EXPECT_EQ(holders, std::vector<int>(state.ViewCount(), 1));
  SfmState whole = state;
  ShareByOrder(1, whole);
  const AdjustmentScope all = AdjustmentScope::Everything(state);
  ASSERT_TRUE(AdjustDistributed(state, all, Thorough(), RunContext{}).ok());
  ASSERT_TRUE(AdjustDistributed(whole, all, Thorough(), RunContext{}).ok());
  EXPECT_NEAR(AdjustmentCost(state, Thorough()) / AdjustmentCost(whole, Thorough()), 1, 1e-6);
  EXPECT_LT((state.poses[9]->translation - whole.poses[9]->translation).norm(), 1e-4);
}

TEST(DistributedAdjustmentTest, ThreadsDoNotChangeTheResult) {
  SfmState one = Disturbed(SyntheticScene{}, true);
  ShareByCluster(kArcs, one);
  SfmState three = one;
  RunContext one_thread, three_threads;
  one_thread.threads = 1, three_threads.threads = 3;
  const AdjustmentScope all = AdjustmentScope::Everything(one);
  ASSERT_TRUE(AdjustDistributed(one, all, {}, one_thread).ok());
  ASSERT_TRUE(AdjustDistributed(three, all, {}, three_threads).ok());
  EXPECT_EQ(one.poses[11]->translation, three.poses[11]->translation);
  EXPECT_EQ(one.tracks[3].position, three.tracks[3].position);
}

TEST(DistributedAdjustmentTest, ViewsOutsideTheScopeStay) {
  SfmState state = Disturbed(SyntheticScene{}, false);
  const SfmState before = state;
  AdjustmentScope scope;
  scope.view_moves.assign(state.ViewCount(), 0);
  scope.view_moves[4] = scope.view_moves[5] = 1;
  ASSERT_TRUE(AdjustDistributed(state, scope, {}, RunContext{}).ok());
  EXPECT_EQ(state.poses[8]->translation, before.poses[8]->translation);
  EXPECT_NE(state.poses[5]->translation, before.poses[5]->translation);
  EXPECT_LT(AdjustmentCost(state, {}), AdjustmentCost(before, {}));
}

TEST(DistributedAdjustmentTest, StopsWhenCancelled) {
  SfmState state = Disturbed(SyntheticScene{}, false);
  RunContext context;
  context.cancelled = [] { return true; };
  EXPECT_EQ(AdjustDistributed(state, AdjustmentScope::Everything(state), {}, context).kind(), StatusKind::kCancelled);
}

}  // namespace
}  // namespace drupe
