#include "reconstruction/arrived_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/files.h"
#include "reconstruction/memory_cache.h"
#include "reconstruction/picture_features.h"
#include "reconstruction/picture_similarity.h"
#include "reconstruction/similarity/ring_of_looks.h"
#include "reconstruction/similarity/vocabulary.h"

namespace drupe {
namespace {

constexpr int kArrivals = 6;
constexpr int kTrainedOn = 3;

/// Pictures of the sample, with few features.
class ArrivedPictureTest : public testing::Test {
 protected:
  ArrivedPictureTest() {
    for (int i = 0; i <= kArrivals; ++i) {
      const std::string name = "0" + std::to_string(i) + ".jpg";
      const std::string bytes = ReadFile(std::string(DRUPE_TEST_DATA) + "/plum-s/images/" + name).value();
      all_.push_back({name, [bytes]() -> Result<std::string> { return bytes; }, "digest of " + name});
    }
    extra_ = all_.back();
    all_.pop_back();
    options_.features.first_octave = 0;
    options_.features.max_features = 500;
    options_.similarity.training_images = kTrainedOn;
    options_.clusters.exhaustive_max_images = 0;
    options_.clusters.max_cluster_size = 3;
    set_.cache = &cache_;
  }

  /// What a prepare job does.
  std::vector<std::string> Arrive(const SourceImage& picture) {
    const auto same = [&](const SourceImage& image) { return image.name == picture.name; };
    std::erase_if(set_.images, same);
    set_.images.push_back(picture);
    std::sort(set_.images.begin(), set_.images.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    return Compare(picture);
  }
  std::vector<std::string> Compare(const SourceImage& picture) {
    const Features features = FindFeatures(picture, set_, options_, {}).value();
    cache_.TakeMisses();
    return DescribeArrived(picture, features, set_, options_, {}).value();
  }

  SimilarityGraph Reconstruct(DerivedCache* cache) {
    ReconstructionInput input = set_;
    std::vector<Features> features;
    for (const SourceImage& image : set_.images) features.push_back(FindFeatures(image, input, options_, {}).value());
    input.cache = cache;
    const std::string vocabulary = LoadVocabulary(input, options_.similarity).value();
    return FindSimilarity(input.images, features, input, options_, vocabulary, {}).value();
  }
  /// The graph with what is known is the one without; gives how much was not known.
  int MissesOfReconstruction() {
    cache_.TakeMisses();
    const SimilarityGraph known = Reconstruct(&cache_);
    const int misses = cache_.TakeMisses();
    const SimilarityGraph alone = Reconstruct(nullptr);
    EXPECT_EQ(known.fisher_distance, alone.fisher_distance);
    EXPECT_EQ(known.weight, alone.weight);
    return misses;
  }

  MemoryCache cache_;
  std::vector<SourceImage> all_;
  SourceImage extra_;
  ReconstructionInput set_;
  ReconstructionOptions options_;
};

TEST_F(ArrivedPictureTest, InOrderNothingIsLeftForTheReconstruction) {
  const std::vector<int> expected = {0, 0, 1 + kTrainedOn, 1, 1, 1};
  for (int i = 0; i < kArrivals; ++i) {
    const std::vector<std::string> candidates = Arrive(all_[i]);
    EXPECT_EQ(cache_.TakeMisses(), expected[i]) << i;
    EXPECT_EQ(candidates.size(), i + 1 < kTrainedOn ? 0u : static_cast<std::size_t>(i)) << i;
    EXPECT_TRUE(candidates.empty() || candidates.front() == all_[i - 1].name) << i;
  }
  EXPECT_EQ(MissesOfReconstruction(), 0);
}

TEST_F(ArrivedPictureTest, ManyMayComeBeforeTheFirstIsLookedAt) {
  set_.images = all_;
  for (const SourceImage& picture : all_) Compare(picture);
  EXPECT_EQ(MissesOfReconstruction(), 0);
}

TEST_F(ArrivedPictureTest, InReverseOrderNoWordsAreTrainedInVain) {
  for (auto picture = all_.rbegin(); picture != all_.rend(); ++picture) {
    EXPECT_TRUE(Arrive(*picture).empty());
    EXPECT_EQ(cache_.TakeMisses(), 0);
  }
  EXPECT_EQ(MissesOfReconstruction(), 1 + kArrivals);
}

TEST_F(ArrivedPictureTest, AReplacedPictureOfTheFrontChangesTheWords) {
  SourceImage wrong = extra_;
  wrong.name = all_[1].name;
  for (int i = 0; i < kArrivals; ++i) Arrive(i == 1 ? wrong : all_[i]);
  Arrive(all_[1]);
  EXPECT_EQ(MissesOfReconstruction(), 1 + kArrivals);
  EXPECT_TRUE(Compare(wrong).empty());  // a job that was late
  EXPECT_EQ(cache_.TakeMisses(), 0);
  Compare(all_[1]);  // twice
  EXPECT_EQ(MissesOfReconstruction(), 0);
}

TEST_F(ArrivedPictureTest, BlankPicturesInFrontDoNotCount) {
  options_.similarity.descriptors_per_image = 100'000;  // an eighth of which none has
  for (const SourceImage& picture : all_) EXPECT_TRUE(Arrive(picture).empty());
  EXPECT_EQ(MissesOfReconstruction(), 1 + kArrivals);
}

TEST_F(ArrivedPictureTest, InLoadedWordsTheFirstIsDescribedAtOnce) {
  options_.similarity.vocabulary = "words";
  set_.read_vocabulary = [](const std::string&) { return TrainVocabulary(Ring(3), {}, {}); };
  for (auto picture = all_.rbegin(); picture != all_.rend(); ++picture) {
    Arrive(*picture);
    EXPECT_EQ(cache_.TakeMisses(), 1);
  }
  EXPECT_EQ(MissesOfReconstruction(), 0);
}

TEST_F(ArrivedPictureTest, WordsOfTheWholeSetAreLeftToTheReconstruction) {
  options_.similarity.training_images = 0;
  for (const SourceImage& picture : all_) EXPECT_TRUE(Arrive(picture).empty());
  EXPECT_EQ(MissesOfReconstruction(), 1 + kArrivals);
}

}  // namespace
}  // namespace drupe
