#include "reconstruction/matching/tracks.h"

#include <gtest/gtest.h>

#include <vector>

namespace drupe {
namespace {

/// `count` keypoints at different places.
Features View(int count) {
  Features features;
  for (int i = 0; i < count; ++i) features.keypoints.push_back({static_cast<float>(10 * i), 5, 2, 0, 0.1f});
  return features;
}

TwoViewMatches Pair(int first, int second, std::vector<FeatureMatch> matches) {
  TwoViewMatches pair;
  pair.pair = {first, second};
  pair.matches = std::move(matches);
  return pair;
}

TEST(TracksTest, JoinsPairsIntoTracks) {
  const std::vector<Features> features = {View(3), View(3), View(3)};
  MatchGraph graph;
  graph.pairs = {Pair(0, 1, {{0, 1}, {2, 2}}), Pair(1, 2, {{1, 0}})};
  const Result<TrackList> list = RunTracks(graph, features, {}, {});
  ASSERT_TRUE(list.ok());
  ASSERT_EQ(list->tracks.size(), 2u);
  EXPECT_EQ(list->tracks[0], (std::vector<FeatureRef>{{0, 0}, {1, 1}, {2, 0}}));
  EXPECT_EQ(list->tracks[1], (std::vector<FeatureRef>{{0, 2}, {1, 2}}));
}

TEST(TracksTest, WeakerPairYieldsInAConflict) {
  const std::vector<Features> features = {View(3), View(3), View(3)};
  MatchGraph graph;
  // 0-1 and 1-2 say (0,0) is (2,0); the weaker 0-2 says it is (2,1).
  graph.pairs = {Pair(0, 1, {{0, 0}, {1, 1}}), Pair(0, 2, {{0, 1}}), Pair(1, 2, {{0, 0}, {2, 2}})};
  const Result<TrackList> list = RunTracks(graph, features, {}, {});
  ASSERT_TRUE(list.ok());
  ASSERT_FALSE(list->tracks.empty());
  EXPECT_EQ(list->tracks[0], (std::vector<FeatureRef>{{0, 0}, {1, 0}, {2, 0}}));
  for (const std::vector<FeatureRef>& track : list->tracks) {
    for (std::size_t i = 1; i < track.size(); ++i) EXPECT_LT(track[i - 1].view, track[i].view);
  }
}

TEST(TracksTest, OrientationsOfOnePlaceAreOne) {
  std::vector<Features> features = {View(1), View(1), View(1)};
  features[0].keypoints.push_back(features[0].keypoints[0]);
  features[0].keypoints[1].orientation_rad = 2;
  MatchGraph graph;
  graph.pairs = {Pair(0, 1, {{0, 0}}), Pair(0, 2, {{1, 0}})};
  const Result<TrackList> list = RunTracks(graph, features, {}, {});
  ASSERT_TRUE(list.ok());
  ASSERT_EQ(list->tracks.size(), 1u);
  EXPECT_EQ(list->tracks[0].size(), 3u);
}

TEST(TracksTest, ShortTracksAreDropped) {
  const std::vector<Features> features = {View(2), View(2), View(2)};
  MatchGraph graph;
  graph.pairs = {Pair(0, 1, {{0, 0}, {1, 1}}), Pair(1, 2, {{0, 0}})};
  TrackOptions options;
  options.min_length = 3;
  const Result<TrackList> list = RunTracks(graph, features, options, {});
  ASSERT_TRUE(list.ok());
  EXPECT_EQ(list->tracks.size(), 1u);
}

TEST(TracksTest, RefusesBadInput) {
  const std::vector<Features> features = {View(1), View(1)};
  MatchGraph graph;
  graph.pairs = {Pair(0, 1, {{0, 1}})};
  EXPECT_EQ(RunTracks(graph, features, {}, {}).status().code(), "invalid_match");
  TrackOptions options;
  options.min_length = 1;
  EXPECT_EQ(RunTracks({}, features, options, {}).status().field(), "min_length");
}

}  // namespace
}  // namespace drupe
