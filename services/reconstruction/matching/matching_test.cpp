#include "reconstruction/matching/matching.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <vector>

#include "reconstruction/matching/nearest.h"
#include "reconstruction/matching/set_matcher.h"
#include "reconstruction/matching/static_features.h"
#include "scene/descriptor_distance.h"

namespace drupe {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  /// A descriptor as RootSIFT makes them: squared norm about 512^2.
  std::vector<std::uint8_t> Descriptor() {
    std::vector<std::uint8_t> values(Features::kDimension);
    for (std::uint8_t& value : values) value = static_cast<std::uint8_t>(Uniform(0, 78));
    return values;
  }

 private:
  std::mt19937_64 engine_;
};

/// A cloud of points with a look of its own each, seen by a camera that circles it.
class TurntableScene {
 public:
  static constexpr int kPoints = 400;

  TurntableScene() : random_(17) {
    camera_.width = 1000;
    camera_.height = 800;
    camera_.fx = camera_.fy = 1200;
    camera_.cx = 500;
    camera_.cy = 400;
    camera_.dist = {-0.05, 0.01, 0, 0, 0};
    for (int i = 0; i < kPoints; ++i) {
      points_.emplace_back(random_.Uniform(-1, 1), random_.Uniform(-1, 1), random_.Uniform(-1, 1));
      looks_.push_back(random_.Descriptor());
    }
  }

  Rigid3 Pose(double view) const {
    return {Eigen::AngleAxisd(0.15 * view, Eigen::Vector3d::UnitY()).toRotationMatrix(), {0, 0, 6}};
  }

  Features See(double view) const {
    Features features;
    for (int i = 0; i < kPoints; ++i) Add(*camera_.Project(Pose(view) * points_[i]), looks_[i], features);
    return features;
  }

  static void Add(const Eigen::Vector2d& pixel, const std::vector<std::uint8_t>& look, Features& features) {
    features.keypoints.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), 2, 0, 0.1f});
    features.descriptors.insert(features.descriptors.end(), look.begin(), look.end());
  }

  const PinholeCamera& camera() const { return camera_; }

 private:
  Random random_;
  PinholeCamera camera_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::vector<std::uint8_t>> looks_;
};

void ExpectSame(const TwoViewMatches& a, const TwoViewMatches& b) {
  EXPECT_EQ(a.pair, b.pair);
  EXPECT_EQ(a.second_from_first.rotation, b.second_from_first.rotation);
  EXPECT_EQ(a.second_from_first.translation, b.second_from_first.translation);
  EXPECT_TRUE(std::equal(a.matches.begin(), a.matches.end(), b.matches.begin(), b.matches.end(),
                         [](FeatureMatch x, FeatureMatch y) { return x.first == y.first && x.second == y.second; }));
}

TEST(NearestTest, EqualsComparisonOneByOne) {
  Random random(1);
  Features a, b;
  for (int i = 0; i < 61; ++i) TurntableScene::Add({0, 0}, random.Descriptor(), a);
  for (int i = 0; i < 83; ++i) TurntableScene::Add({0, 0}, random.Descriptor(), b);
  std::vector<std::uint32_t> all_a(a.size()), all_b(b.size());
  std::iota(all_a.begin(), all_a.end(), 0u);
  std::iota(all_b.begin(), all_b.end(), 0u);
  const std::vector<Nearest> nearest = FindNearest(PackedDescriptors(a, all_a), all_a, PackedDescriptors(b, all_b));
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::vector<std::pair<std::int32_t, int>> distances;
    for (std::size_t j = 0; j < b.size(); ++j) {
      distances.emplace_back(SquaredDistance(a.Descriptor(i), b.Descriptor(j)), static_cast<int>(j));
    }
    std::sort(distances.begin(), distances.end());
    EXPECT_NEAR(nearest[i].squared_distance, distances[0].first, 1);
    EXPECT_NEAR(nearest[i].second_squared_distance, distances[1].first, 1);
    EXPECT_EQ(nearest[i].index, distances[0].second);
  }
}

TEST(NearestTest, ExtremeValuesAndMissingOnes) {
  Features dark, bright;
  TurntableScene::Add({0, 0}, std::vector<std::uint8_t>(128, 0), dark);
  TurntableScene::Add({0, 0}, std::vector<std::uint8_t>(128, 255), bright);
  const std::vector<std::uint32_t> one = {0};
  const std::vector<Nearest> apart = FindNearest(PackedDescriptors(dark, one), one, PackedDescriptors(bright, one));
  EXPECT_NEAR(apart[0].squared_distance, 128 * 255 * 255, 1);
  EXPECT_EQ(apart[0].second_squared_distance, std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(FindNearest(PackedDescriptors(dark, one), one, PackedDescriptors())[0].index, -1);
}

TEST(MatchingTest, FindsPosesAndMatchesOfATurntable) {
  const TurntableScene scene;
  const std::vector<Features> features = {scene.See(0), scene.See(1), scene.See(3)};
  ViewClusters clusters;
  clusters.pairs = {{0, 1}, {0, 2}, {1, 2}};
  const Result<MatchGraph> graph = RunMatching(features, clusters, scene.camera(), {}, {});
  ASSERT_TRUE(graph.ok());
  ASSERT_EQ(graph->pairs.size(), 3u);
  const std::vector<int> views = {0, 1, 3};
  for (const TwoViewMatches& pair : graph->pairs) {
    EXPECT_GT(pair.matches.size(), 390u);
    for (const FeatureMatch& match : pair.matches) EXPECT_EQ(match.first, match.second);
    const Rigid3 truth = scene.Pose(views[pair.pair.second]) * scene.Pose(views[pair.pair.first]).Inverse();
    EXPECT_LT((pair.second_from_first.rotation - truth.rotation).norm(), 1e-4);
    EXPECT_LT((pair.second_from_first.translation - truth.translation.normalized()).norm(), 1e-3);
    EXPECT_LT(pair.homography_inlier_share, 0.3);
    EXPECT_NEAR(pair.median_triangulation_angle_rad, 0.15 * (views[pair.pair.second] - views[pair.pair.first]), 0.03);
  }
}

/// A guess of the focal length that is 30 % too long; what is matched is verified without it.
TEST(MatchingTest, AFundamentalMatrixNeedsNoCalibration) {
  const TurntableScene scene;
  const std::vector<Features> features = {scene.See(0), scene.See(1), scene.See(2)};
  ViewClusters clusters;
  clusters.pairs = {{0, 1}, {0, 2}, {1, 2}};
  PinholeCamera guess = scene.camera();
  guess.fx = guess.fy = 1560;
  guess.dist = {};
  MatchingOptions options;
  options.guessed_lens = GuessedLens::kFundamental;
  const Result<MatchGraph> graph = RunMatching(features, clusters, guess, options, {}, true);
  ASSERT_TRUE(graph.ok());
  ASSERT_EQ(graph->pairs.size(), 3u);
  for (const TwoViewMatches& pair : graph->pairs) {
    EXPECT_GT(pair.matches.size(), 380u);
    for (const FeatureMatch& match : pair.matches) EXPECT_EQ(match.first, match.second);
    EXPECT_TRUE(pair.calibrated);
  }
}

TEST(MatchingTest, GuidedMatchingFindsWhatTheFirstLeftOut) {
  const TurntableScene scene;
  const std::vector<Features> features = {scene.See(0), scene.See(1)};
  ViewClusters clusters;
  clusters.pairs = {{0, 1}};
  MatchingOptions options;
  options.exhaustive_features = 100;
  options.guided = false;
  const Result<MatchGraph> alone = RunMatching(features, clusters, scene.camera(), options, {});
  options.guided = true;
  const Result<MatchGraph> guided = RunMatching(features, clusters, scene.camera(), options, {});
  ASSERT_TRUE(alone.ok() && guided.ok());
  EXPECT_LE(alone->pairs.at(0).matches.size(), 100u);
  EXPECT_GT(guided->pairs.at(0).matches.size(), 350u);
  for (const FeatureMatch& match : guided->pairs[0].matches) EXPECT_EQ(match.first, match.second);
}

TEST(MatchingTest, UnrelatedPicturesAndStillScenesAreDropped) {
  const TurntableScene scene;
  Random random(99);
  Features other;
  for (int i = 0; i < 400; ++i) {
    TurntableScene::Add({random.Uniform(0, 1000), random.Uniform(0, 800)}, random.Descriptor(), other);
  }
  const std::vector<Features> features = {scene.See(0), other, scene.See(0)};
  ViewClusters clusters;
  clusters.pairs = {{0, 1}, {0, 2}};
  const Result<MatchGraph> graph = RunMatching(features, clusters, scene.camera(), {}, {});
  ASSERT_TRUE(graph.ok());
  EXPECT_TRUE(graph->pairs.empty());
}

TEST(MatchingTest, SameResultForAnyNumberOfThreads) {
  const TurntableScene scene;
  const std::vector<Features> features = {scene.See(0), scene.See(1), scene.See(2)};
  ViewClusters clusters;
  clusters.pairs = {{0, 1}, {0, 2}, {1, 2}};
  RunContext one, four;
  one.threads = 1;
  four.threads = 4;
  const Result<MatchGraph> a = RunMatching(features, clusters, scene.camera(), {}, one);
  const Result<MatchGraph> b = RunMatching(features, clusters, scene.camera(), {}, four);
  ASSERT_TRUE(a.ok() && b.ok());
  ASSERT_EQ(a->pairs.size(), b->pairs.size());
  for (std::size_t i = 0; i < a->pairs.size(); ++i) ExpectSame(a->pairs[i], b->pairs[i]);
}

TEST(MatchingTest, WhatIsKnownOfAPairIsNotMatchedAgain) {
  const TurntableScene scene;
  const std::vector<Features> features = {scene.See(0), scene.See(1), scene.See(2)};
  ViewClusters clusters;
  clusters.pairs = {{0, 1}, {0, 2}, {1, 2}};
  const SetMatcher matcher(scene.camera(), false, {}, RunContext().seed);
  const auto all_take_part = [](const Features& picture) { return std::vector<std::uint8_t>(picture.size(), 0); };
  const PreparedPicture first = matcher.Prepare(features[0], all_take_part(features[0]));
  const PreparedPicture second = matcher.Prepare(features[1], all_take_part(features[1]));
  const FindKnownPair find = [&](const ImagePair& pair) -> std::optional<KnownPair> {
    if (pair == ImagePair{0, 1}) return KnownPair{matcher.Match(first, second, pair)};
    return pair == ImagePair{0, 2} ? std::optional(KnownPair{}) : std::nullopt;  // failed; has to be matched
  };
  MatchingOptions options;
  options.drop_static = false;
  const Result<MatchGraph> alone = RunMatching(features, clusters, scene.camera(), options, {});
  const Result<MatchGraph> known = RunMatching(features, clusters, scene.camera(), options, {}, false, find);
  ASSERT_TRUE(alone.ok() && known.ok());
  ASSERT_EQ(alone->pairs.size(), 3u);
  ASSERT_EQ(known->pairs.size(), 2u);
  ExpectSame(known->pairs[0], alone->pairs[0]);
  ExpectSame(known->pairs[1], alone->pairs[2]);
}

TEST(MatchingTest, RefusesBadInput) {
  const TurntableScene scene;
  const std::vector<Features> features = {scene.See(0), scene.See(1)};
  ViewClusters clusters;
  clusters.pairs = {{0, 2}};
  EXPECT_EQ(RunMatching(features, clusters, scene.camera(), {}, {}).status().code(), "invalid_pair");
  MatchingOptions options;
  options.max_ratio = 0;
  EXPECT_EQ(RunMatching(features, {}, scene.camera(), options, {}).status().field(), "max_ratio");
}

TEST(StaticFeaturesTest, FindsTheBoxBehindTheTurntable) {
  const TurntableScene scene;
  Random random(5);
  std::vector<std::pair<Eigen::Vector2d, std::vector<std::uint8_t>>> box;
  for (int i = 0; i < 30; ++i) {
    box.push_back({{random.Uniform(0, 1000), random.Uniform(0, 800)}, random.Descriptor()});
  }
  std::vector<Features> features;
  for (int view = 0; view < 8; ++view) {
    features.push_back(scene.See(view));
    for (const auto& [place, look] : box) TurntableScene::Add(place, look, features.back());
  }
  const auto is_static = FindStaticFeatures(features, 1, 0.25, {});
  ASSERT_TRUE(is_static.ok());
  for (const std::vector<std::uint8_t>& view : *is_static) {
    // Of the scene's points, one on the very axis may pass for static.
    EXPECT_LE(std::accumulate(view.begin(), view.begin() + TurntableScene::kPoints, 0), 4);
    EXPECT_EQ(std::accumulate(view.begin() + TurntableScene::kPoints, view.end(), 0), 30);
  }
}

TEST(StaticFeaturesTest, WhatComesLaterChangesNothing) {
  const TurntableScene scene;
  std::vector<Features> features;
  for (int view = 0; view < 30; ++view) {
    features.push_back(scene.See(view));
    TurntableScene::Add({100, 100}, std::vector<std::uint8_t>(Features::kDimension, 45), features.back());
  }
  const auto all = FindStaticFeatures(features, 1, 0.25, {});
  const auto some = FindStaticFeatures(std::span(features).first(20), 1, 0.25, {});
  ASSERT_TRUE(all.ok() && some.ok());
  for (std::size_t i = 0; i < some->size(); ++i) {
    EXPECT_EQ(some->at(i), all->at(i)) << i;
    EXPECT_EQ(some->at(i).back(), 1) << i;
    std::vector<Features> compared;
    for (const std::size_t other : ComparedForStatic(i, features.size())) compared.push_back(features[other]);
    EXPECT_EQ(compared.size(), i < kComparedForStatic ? kComparedForStatic - 1 : kComparedForStatic) << i;
    EXPECT_EQ(FindStaticFeatures(features[i], compared, 1, 0.25), all->at(i)) << i;
  }
}

TEST(StaticFeaturesTest, WhatMovesSlowlyDoesNotStandStill) {
  const TurntableScene scene;
  constexpr double kOneDegree = 0.01745 / 0.15;
  std::vector<Features> features;
  for (int view = 0; view < 40; ++view) features.push_back(scene.See(view * kOneDegree));
  const auto is_static = FindStaticFeatures(features, 1, 0.25, {});
  ASSERT_TRUE(is_static.ok());
  for (const std::vector<std::uint8_t>& view : *is_static) {
    // Those near the axis, and of the first pictures some at the edge, which turn to and fro. Without a look at
    // pictures farther away they would be up to 56.
    EXPECT_LE(std::accumulate(view.begin(), view.end(), 0), 24);
  }
}

TEST(StaticFeaturesTest, APictureIsComparedWithOthersSpreadOverThoseBeforeIt) {
  for (const std::size_t image : {0, 5, 11, 12, 40, 359}) {
    const std::vector<std::size_t> others = ComparedForStatic(image, 360);
    const std::set<std::size_t> once(others.begin(), others.end());
    EXPECT_EQ(once.size(), others.size());
    EXPECT_EQ(once.count(image), 0u);
    EXPECT_GE(std::max(others.back(), image) - std::min(others.back(), image),
              std::max(others.front(), image) - std::min(others.front(), image));
    EXPECT_LE(*once.rbegin(), std::max<std::size_t>(image, 11));
    EXPECT_GE(*once.rbegin() - *once.begin(), image * 4 / 5);
  }
  EXPECT_TRUE(ComparedForStatic(0, 1).empty());
  EXPECT_EQ(ComparedForStatic(1, 3), (std::vector<std::size_t>{2, 0}));
}

TEST(StaticFeaturesTest, OnePictureHasNone) {
  const TurntableScene scene;
  const std::vector<Features> features = {scene.See(0)};
  const auto is_static = FindStaticFeatures(features, 1, 0.25, {});
  ASSERT_TRUE(is_static.ok());
  EXPECT_EQ(std::accumulate(is_static->at(0).begin(), is_static->at(0).end(), 0), 0);
}

}  // namespace
}  // namespace drupe
