#include "reconstruction/sparse/track_completion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "reconstruction/sparse/synthetic_scene.h"
#include "reconstruction/sparse/track_triangulation.h"

namespace drupe {
namespace {

constexpr double kGatePx = 1.5;

SyntheticScene::Options WithoutWrongOnes() {
  SyntheticScene::Options options;
  options.wrong_share = 0;
  options.noise_px = 0.2;
  return options;
}

/// The scene of the other tests, in which every point has its own look.
class TrackCompletionTest : public testing::Test {
 protected:
  TrackCompletionTest() : scene_(WithoutWrongOnes()), whole_(scene_.tracks.tracks) {
    std::mt19937 random(5);
    for (Features& view : scene_.features) view.descriptors.resize(view.size() * Features::kDimension);
    for (const auto& track : whole_) {
      std::vector<int> look(Features::kDimension);
      for (int& value : look) value = 10 + static_cast<int>(random() % 70);
      for (const FeatureRef& ref : track) {
        for (int k = 0; k < Features::kDimension; ++k) {
          Descriptor(ref)[k] = static_cast<std::uint8_t>(look[k] + static_cast<int>(random() % 9));
        }
      }
    }
  }

  std::uint8_t* Descriptor(const FeatureRef& ref) {
    return scene_.features[ref.view].descriptors.data() + ref.keypoint * Features::kDimension;
  }
  Keypoint& KeypointOf(const FeatureRef& ref) { return scene_.features[ref.view].keypoints[ref.keypoint]; }

  /// Another feature with the look of the last one in a view, this many pixels beside it.
  FeatureRef Twin(const FeatureRef& ref, float beside_px) {
    Features& view = scene_.features[ref.view];
    EXPECT_EQ(ref.keypoint + 1, view.size());
    Keypoint twin = view.keypoints[ref.keypoint];
    twin.x += beside_px;
    const std::vector<std::uint8_t> look(Descriptor(ref), Descriptor(ref) + Features::kDimension);
    view.keypoints.push_back(twin);
    view.descriptors.insert(view.descriptors.end(), look.begin(), look.end());
    return {ref.view, ref.keypoint + 1};
  }

  /// What the matches have left, with true poses.
  SfmState StateOf(const std::vector<std::vector<FeatureRef>>& tracks) {
    scene_.tracks.tracks = tracks;
    SfmState state = MakeSfmState(scene_.Input(false));
    for (std::size_t v = 0; v < scene_.poses.size(); ++v) state.poses[v] = scene_.poses[v];
    EXPECT_TRUE(UpdateTracks(state, TriangulationOptions{kGatePx, 0.035}, RunContext{}).ok());
    return state;
  }

  CompletionCounts Complete(SfmState& state, int threads = 1) {
    RunContext context;
    context.threads = threads;
    const auto counts = CompleteTracks(scene_.features, scene_.matches.is_static, kGatePx, context, state);
    EXPECT_TRUE(counts.ok());
    return *counts;
  }

  /// Every third track without its last view.
  std::vector<std::vector<FeatureRef>> Shortened() const {
    auto tracks = whole_;
    for (std::size_t t = 0; t < tracks.size(); t += 3) {
      if (tracks[t].size() > 3) tracks[t].pop_back();
    }
    return tracks;
  }

  SyntheticScene scene_;
  std::vector<std::vector<FeatureRef>> whole_;
};

std::vector<std::vector<FeatureRef>> TracksOf(const SfmState& state) {
  std::vector<std::vector<FeatureRef>> tracks;
  for (const SfmTrack& track : state.tracks) {
    tracks.emplace_back();
    for (const SfmObservation& o : state.ObservationsOf(track)) tracks.back().push_back({o.view, o.keypoint});
  }
  return tracks;
}

std::size_t CountIn(const std::vector<std::vector<FeatureRef>>& tracks,
                    const std::vector<std::vector<FeatureRef>>& others) {
  return static_cast<std::size_t>(std::count_if(tracks.begin(), tracks.end(), [&](const auto& track) {
    return std::find(others.begin(), others.end(), track) != others.end();
  }));
}

TEST_F(TrackCompletionTest, TakesInWhatMatchingMissed) {
  SfmState state = StateOf(Shortened());
  const std::size_t missing = whole_.size() - CountIn(TracksOf(state), whole_);
  ASSERT_GT(missing, 100u);
  const CompletionCounts counts = Complete(state);
  EXPECT_EQ(counts.merged, 0);
  EXPECT_EQ(state.tracks.size(), whole_.size());
  EXPECT_GE(CountIn(TracksOf(state), whole_), whole_.size() - missing / 10);
  EXPECT_GE(counts.added, static_cast<int>(missing - missing / 10));
  EXPECT_LE(counts.added, static_cast<int>(missing));
  for (const SfmObservation& o : state.observations) {
    const SfmTrack& track = state.tracks[o.track];
    if (!o.is_active) continue;
    EXPECT_LE(ErrorPx(*state.poses[o.view], o.measured, track.position), kGatePx);
  }
}

TEST_F(TrackCompletionTest, JoinsTheTracksOfOnePoint) {
  std::vector<std::vector<FeatureRef>> halves;
  for (const auto& track : whole_) {
    const auto middle = track.begin() + static_cast<std::ptrdiff_t>(track.size() / 2);
    if (track.size() < 6) {
      halves.push_back(track);
      continue;
    }
    halves.emplace_back(track.begin(), middle);
    halves.emplace_back(middle, track.end());
  }
  SfmState state = StateOf(halves);
  const auto cut = static_cast<int>(halves.size() - whole_.size());
  ASSERT_GT(cut, 300);
  const CompletionCounts counts = Complete(state);
  EXPECT_GE(counts.merged, cut * 9 / 10);
  EXPECT_LE(counts.merged, cut);
  EXPECT_GE(static_cast<int>(CountIn(TracksOf(state), whole_)), static_cast<int>(whole_.size()) - cut / 10);
}

TEST_F(TrackCompletionTest, LeavesTracksThatSeeTheSameViewApart) {
  std::vector<std::vector<FeatureRef>> tracks = whole_;
  const std::vector<FeatureRef> cut = tracks.back();
  ASSERT_GE(cut.size(), 6u);
  const auto middle = cut.begin() + static_cast<std::ptrdiff_t>(cut.size() / 2);
  tracks.back() = {cut.begin(), middle};
  tracks.back().push_back(Twin(*middle, 0.3f));  // what the other half sees in that view stays another place
  tracks.emplace_back(middle, cut.end());
  SfmState state = StateOf(tracks);
  EXPECT_EQ(Complete(state).merged, 0);
  EXPECT_EQ(TracksOf(state), tracks);
}

TEST_F(TrackCompletionTest, JoinsByAnyOrientationOfAPlace) {
  std::vector<std::vector<FeatureRef>> tracks = whole_;
  const std::vector<FeatureRef> cut = tracks.back();
  const auto middle = cut.begin() + static_cast<std::ptrdiff_t>(cut.size() / 2);
  tracks.back() = {cut.begin(), middle};
  tracks.emplace_back(middle, cut.end());
  for (const FeatureRef& ref : std::vector(cut.begin(), middle)) {
    Twin(ref, 0);
    for (int k = 0; k < Features::kDimension; k += 2)
      Descriptor(ref)[k] += 6;  // the other half looks more like the twin
  }
  SfmState state = StateOf(tracks);
  const CompletionCounts counts = Complete(state);
  EXPECT_EQ(counts.merged, 1);
  EXPECT_EQ(counts.added, 0);
}

TEST_F(TrackCompletionTest, LeavesWhatLooksOrMeasuresOtherwise) {
  const auto shortened = Shortened();
  for (std::size_t t = 0; t < whole_.size(); ++t) {
    if (shortened[t].size() == whole_[t].size()) continue;
    const FeatureRef& left = whole_[t].back();
    if (t % 2 == 0) {
      std::reverse(Descriptor(left), Descriptor(left) + Features::kDimension);
    } else {
      KeypointOf(left).scale_px *= 2;
    }
  }
  SfmState state = StateOf(shortened);
  EXPECT_EQ(Complete(state).added, 0);
  EXPECT_EQ(TracksOf(state), shortened);
}

TEST_F(TrackCompletionTest, LeavesTheStaticBackground) {
  for (const Features& view : scene_.features) scene_.matches.is_static.emplace_back(view.size(), 1);
  SfmState state = StateOf(Shortened());
  EXPECT_EQ(Complete(state).added, 0);
}

TEST_F(TrackCompletionTest, LeavesFeaturesThatAreElsewhere) {
  const auto shortened = Shortened();
  for (std::size_t t = 0; t < whole_.size(); ++t) {
    if (shortened[t].size() < whole_[t].size()) KeypointOf(whole_[t].back()).x += 3;
  }
  SfmState state = StateOf(shortened);
  EXPECT_EQ(Complete(state).added, 0);
}

TEST_F(TrackCompletionTest, NeedsDescriptors) {
  SfmState state = StateOf(Shortened());
  const auto before = TracksOf(state);
  for (Features& view : scene_.features) view.descriptors.clear();
  EXPECT_EQ(Complete(state).added, 0);
  EXPECT_EQ(TracksOf(state), before);
}

TEST_F(TrackCompletionTest, IsTheSameWithAnyNumberOfThreads) {
  SfmState one = StateOf(Shortened()), two = StateOf(Shortened());
  Complete(one, 1);
  Complete(two, 2);
  EXPECT_EQ(TracksOf(one), TracksOf(two));
}

TEST_F(TrackCompletionTest, EndsWhenCancelled) {
  SfmState state = StateOf(Shortened());
  RunContext context;
  context.cancelled = [] { return true; };
  EXPECT_EQ(CompleteTracks(scene_.features, {}, kGatePx, context, state).status().kind(), StatusKind::kCancelled);
}

}  // namespace
}  // namespace drupe
