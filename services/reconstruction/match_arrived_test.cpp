#include "reconstruction/match_arrived.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/json.h"
#include "reconstruction/matching/static_features.h"
#include "reconstruction/memory_cache.h"
#include "reconstruction/picture_features.h"
#include "reconstruction/picture_matching.h"

namespace drupe {
namespace {

constexpr int kStaticFront = static_cast<int>(kComparedForStatic);
constexpr int kAllArrivals = kStaticFront + 2;

/// Pictures of the sample, with few features.
class MatchArrivedTest : public testing::Test {
 protected:
  MatchArrivedTest() {
    const std::string directory = std::string(DRUPE_TEST_DATA) + "/plum-s";
    for (int i = 0; i <= kAllArrivals; ++i) {
      const std::string name = (i < 10 ? "0" : "") + std::to_string(i) + ".jpg";
      const std::string bytes = ReadFile(directory + "/images/" + name).value();
      all_.push_back({name, [bytes]() -> Result<std::string> { return bytes; }, "digest of " + name});
    }
    extra_ = all_.back();
    all_.pop_back();
    options_.features.first_octave = 0;
    options_.features.max_features = 800;
    options_.clusters.sequence_window = 2;
    set_.calibration = ParseCalibration(ParseJson(ReadFile(directory + "/calibration.json").value()).value()).value();
    set_.cache = &cache_;
  }

  /// Gives how much was made.
  int Arrive(const SourceImage& picture, const std::vector<std::string>& alike = {}) {
    std::erase_if(set_.images, [&](const SourceImage& image) { return image.name == picture.name; });
    set_.images.push_back(picture);
    std::sort(set_.images.begin(), set_.images.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    EXPECT_TRUE(FindFeatures(picture, set_, options_, {}).ok());
    cache_.TakeMisses();
    const Result<int> pairs = MatchArrived(picture, alike, set_, options_, {});
    EXPECT_TRUE(pairs.ok());
    last_pairs_ = pairs.ok() ? *pairs : -1;
    return cache_.TakeMisses();
  }
  bool IsKnown(int first, int second) const {
    return PictureMatching(set_.images, set_, options_, context_).Known({first, second}).has_value();
  }
  /// What is known of pairs is what matching all of the set finds; gives how many are.
  int CompareWithMatchingAll() const {
    std::vector<Features> features;
    for (const SourceImage& image : set_.images) features.push_back(FindFeatures(image, set_, options_, {}).value());
    ViewClusters clusters;
    for (int i = 0; i < kAllArrivals; ++i) {
      for (int j = i + 1; j < kAllArrivals; ++j) {
        if (j - i <= 3 || i == 0) clusters.pairs.push_back({i, j});
      }
    }
    const PictureMatching ahead(set_.images, set_, options_, context_);
    int known = 0;
    const FindKnownPair find = [&](const ImagePair& pair) {
      const std::optional<KnownPair> found = ahead.Known(pair);
      known += found ? 1 : 0;
      return found;
    };
    const auto match = [&](const FindKnownPair& with) {
      return RunMatching(features, clusters, set_.calibration->camera, options_.matching, context_, false, with)
          .value();
    };
    const MatchGraph with = match(find), without = match(nullptr);
    EXPECT_GT(without.pairs.size(), 20u);
    EXPECT_EQ(with.pairs.size(), without.pairs.size());
    for (std::size_t k = 0; k < std::min(with.pairs.size(), without.pairs.size()); ++k) {
      ExpectSame(with.pairs[k], without.pairs[k]);
    }
    return known;
  }
  static void ExpectSame(const TwoViewMatches& a, const TwoViewMatches& b) {
    EXPECT_EQ(a.pair, b.pair);
    EXPECT_EQ(a.putative_count, b.putative_count);
    EXPECT_EQ(a.calibrated, b.calibrated);
    EXPECT_EQ(a.second_from_first.rotation, b.second_from_first.rotation);
    EXPECT_EQ(a.second_from_first.translation, b.second_from_first.translation);
    EXPECT_EQ(a.median_triangulation_angle_rad, b.median_triangulation_angle_rad);
    EXPECT_EQ(a.homography_inlier_share, b.homography_inlier_share);
    EXPECT_TRUE(std::equal(a.matches.begin(), a.matches.end(), b.matches.begin(), b.matches.end(),
                           [](FeatureMatch x, FeatureMatch y) { return x.first == y.first && x.second == y.second; }));
  }

  const RunContext context_ = [] {
    RunContext one;
    one.threads = 1;
    return one;
  }();
  MemoryCache cache_;
  std::vector<SourceImage> all_;
  SourceImage extra_;
  ReconstructionInput set_;
  ReconstructionOptions options_;
  int last_pairs_ = 0;
};

TEST_F(MatchArrivedTest, WhatIsKnownIsWhatMatchingFinds) {
  for (int i = 0; i < kStaticFront - 1; ++i) EXPECT_EQ(Arrive(all_[i]), 0) << i;
  const int front_pairs = 1 + 2 * (kStaticFront - 2);
  EXPECT_EQ(Arrive(all_[kStaticFront - 1]), kStaticFront + front_pairs);  // what stands still, and the pairs
  EXPECT_EQ(last_pairs_, 2);
  EXPECT_EQ(Arrive(all_[kStaticFront], {"00.jpg", "11.jpg"}), 1 + 3);
  EXPECT_EQ(last_pairs_, 3);
  EXPECT_EQ(Arrive(all_[kStaticFront + 1]), 1 + 2);
  EXPECT_TRUE(IsKnown(0, 1));
  EXPECT_TRUE(IsKnown(0, kStaticFront));
  EXPECT_FALSE(IsKnown(1, kStaticFront));
  EXPECT_EQ(CompareWithMatchingAll(), front_pairs + 3 + 2);
}

TEST_F(MatchArrivedTest, InReverseOrderNothingIsMatchedInVain) {
  for (auto picture = all_.rbegin(); picture != all_.rend(); ++picture) EXPECT_EQ(Arrive(*picture), 0);
  EXPECT_EQ(CompareWithMatchingAll(), 0);
  Arrive(all_.back());  // a job that was late does the front too
  EXPECT_TRUE(IsKnown(0, 1));
  EXPECT_TRUE(IsKnown(kAllArrivals - 2, kAllArrivals - 1));
}

TEST_F(MatchArrivedTest, WhatAReplacedPictureToldIsNotBelieved) {
  SourceImage wrong = extra_;
  wrong.name = all_[kStaticFront].name;
  for (int i = 0; i < kAllArrivals; ++i) Arrive(i == kStaticFront ? wrong : all_[i]);
  EXPECT_TRUE(IsKnown(kStaticFront - 1, kStaticFront));
  Arrive(all_[kStaticFront]);
  EXPECT_TRUE(IsKnown(kStaticFront - 1, kStaticFront));
  EXPECT_FALSE(IsKnown(kStaticFront, kStaticFront + 1));  // found with the wrong one
  EXPECT_TRUE(IsKnown(0, 1));
  EXPECT_GT(CompareWithMatchingAll(), 20);
  EXPECT_EQ(Arrive(all_[kStaticFront]), 0);  // twice
  EXPECT_EQ(MatchArrived(wrong, {}, set_, options_, {}).value(), 0);
}

TEST_F(MatchArrivedTest, OptionsAndCalibrationTellKnownPairsApart) {
  for (int i = 0; i < kStaticFront; ++i) Arrive(all_[i]);
  options_.clusters.max_cluster_size = 5;  // of which matching knows nothing
  EXPECT_TRUE(IsKnown(0, 1));
  options_.matching.max_error_px = 2;
  EXPECT_FALSE(IsKnown(0, 1));
  options_.matching.max_error_px = 1.5;
  EXPECT_TRUE(IsKnown(0, 1));
  set_.calibration->camera.fx += 1e-6;
  EXPECT_FALSE(IsKnown(0, 1));
}

TEST_F(MatchArrivedTest, WithoutCalibrationTheCameraIsNotKnownYet) {
  set_.calibration.reset();
  for (const SourceImage& picture : all_) EXPECT_EQ(Arrive(picture), 0);
}

}  // namespace
}  // namespace drupe
