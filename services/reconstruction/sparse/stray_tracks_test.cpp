#include "reconstruction/sparse/stray_tracks.h"

#include <gtest/gtest.h>

#include "reconstruction/sparse/synthetic_scene.h"
#include "reconstruction/sparse/track_triangulation.h"

namespace drupe {
namespace {

SfmState TrueState() {
  SyntheticScene::Options options;
  options.wrong_share = 0;
  const SyntheticScene scene(options);
  SfmState state = MakeSfmState(scene.Input(false));
  for (std::size_t v = 0; v < scene.poses.size(); ++v) state.poses[v] = scene.poses[v];
  EXPECT_TRUE(UpdateTracks(state, TriangulationOptions{}, RunContext{}).ok());
  return state;
}

/// Leaves a track to its first two observations and moves it out along the first one's ray to `factor` times its depth.
void MakeStray(SfmState& state, std::size_t track, double factor) {
  SfmTrack& moved = state.tracks[track];
  const auto observations = state.ObservationsOf(moved);
  for (std::size_t i = 2; i < observations.size(); ++i) observations[i].is_active = false;
  const Eigen::Vector3d centre = state.poses[observations[0].view]->Centre();
  moved.position = centre + factor * (moved.position - centre);
}

TEST(StrayTracksTest, TakesTwoViewTracksFarFromTheScene) {
  SfmState state = TrueState();
  const int before = CountPositions(state);
  MakeStray(state, 10, 5.0);
  MakeStray(state, 20, 0.3);
  EXPECT_EQ(DropStrayTracks(state), 2);
  EXPECT_FALSE(state.tracks[10].has_position);
  EXPECT_FALSE(state.tracks[20].has_position);
  EXPECT_EQ(CountPositions(state), before - 2);
  for (const SfmObservation& o : state.ObservationsOf(state.tracks[10])) EXPECT_FALSE(o.is_active);
}

TEST(StrayTracksTest, KeepsTwoViewTracksOfTheScene) {
  SfmState state = TrueState();
  MakeStray(state, 10, 1.0);
  MakeStray(state, 20, 1.02);
  EXPECT_EQ(DropStrayTracks(state), 0);
}

TEST(StrayTracksTest, DoesNotJudgeByAFewTracks) {
  SfmState state = TrueState();
  for (std::size_t t = 30; t < state.tracks.size(); ++t) state.tracks[t].has_position = false;
  MakeStray(state, 10, 5.0);
  EXPECT_EQ(DropStrayTracks(state), 0);
}

}  // namespace
}  // namespace drupe
