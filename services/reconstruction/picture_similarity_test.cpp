#include "reconstruction/picture_similarity.h"

#include <gtest/gtest.h>

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "reconstruction/clusters/clusters.h"
#include "reconstruction/memory_cache.h"
#include "reconstruction/similarity/ring_of_looks.h"
#include "reconstruction/similarity/vocabulary.h"

namespace drupe {
namespace {

constexpr int kPictures = 15;
constexpr int kFront = 6;

/// A set whose pictures are never read: their features are given.
class PictureSimilarityTest : public testing::Test {
 protected:
  PictureSimilarityTest() : features_(Ring(kPictures)) {
    for (int i = 0; i < kPictures; ++i) {
      pictures_.push_back({"p" + std::to_string(i), nullptr, "digest " + std::to_string(i)});
    }
    options_.similarity.training_images = kFront;
    options_.clusters.exhaustive_max_images = 0;
    input_.cache = &cache_;
  }

  Result<SimilarityGraph> Graph(const std::string& vocabulary = "") {
    return FindSimilarity(pictures_, features_, input_, options_, vocabulary, context_);
  }
  /// How much is made anew.
  int MissesOf(const std::string& vocabulary = "") {
    cache_.TakeMisses();
    EXPECT_TRUE(Graph(vocabulary).ok());
    return cache_.TakeMisses();
  }
  /// How much is made anew after `change`, which is not undone.
  int MissesAfter(const std::function<void()>& change) {
    change();
    return MissesOf();
  }

  MemoryCache cache_;
  std::vector<Features> features_;
  std::vector<SourceImage> pictures_;
  ReconstructionInput input_;
  ReconstructionOptions options_;
  RunContext context_;
};

TEST_F(PictureSimilarityTest, IsTheStagesGraphWithAndWithoutMemory) {
  const SimilarityGraph stage = RunSimilarity(features_, options_.similarity, context_).value();
  const SimilarityGraph made = Graph().value(), remembered = Graph().value();
  EXPECT_EQ(cache_.TakeMisses(), 1 + kPictures);
  input_.cache = nullptr;
  const SimilarityGraph alone = Graph().value();
  for (const SimilarityGraph& graph : {made, remembered, alone}) {
    EXPECT_EQ(graph.fisher_distance, stage.fisher_distance);
    EXPECT_EQ(graph.weight, stage.weight);
  }
}

TEST_F(PictureSimilarityTest, StepsTakenEarlyLeaveNothingToDo) {
  const PictureSimilarity similarity(input_, options_, context_);
  const auto front = std::span(pictures_).first(kFront);
  EXPECT_FALSE(similarity.KnownWords(front));
  const SetWords words = similarity.Words(front, std::span(features_).first(kFront)).value();
  EXPECT_EQ(similarity.KnownWords(front)->sha256, words.sha256);
  EXPECT_FALSE(similarity.KnownDescription(pictures_[2], words));
  for (int i = kPictures - 1; i >= 0; --i) ASSERT_TRUE(similarity.Describe(pictures_[i], features_[i], words).ok());
  EXPECT_TRUE(similarity.KnownDescription(pictures_[2], words));
  EXPECT_EQ(MissesOf(), 0);
}

TEST_F(PictureSimilarityTest, APictureBehindTheFrontIsDescribedAloneWhenItIsReplaced) {
  EXPECT_EQ(MissesOf(), 1 + kPictures);
  EXPECT_EQ(MissesAfter([&] { pictures_[kFront].sha256 = "another"; }), 1);
}

TEST_F(PictureSimilarityTest, WordsFollowFromTheFrontTheOptionsAndTheSeed) {
  EXPECT_EQ(MissesOf(), 1 + kPictures);
  // The features, and therefore the words, are the same: only what names them is not.
  EXPECT_EQ(MissesAfter([&] { pictures_[kFront - 1].sha256 = "another"; }), 1 + 1);
  EXPECT_EQ(MissesAfter([&] { options_.similarity.gaussians = 8; }), 1 + kPictures);
  EXPECT_EQ(MissesAfter([&] { options_.similarity.descriptors_per_image = 100; }), 1 + kPictures);
  EXPECT_EQ(MissesAfter([&] { options_.features.max_features = 1000; }), 1 + kPictures);
  EXPECT_EQ(MissesAfter([&] { context_.seed = 2; }), 1 + kPictures);
  EXPECT_EQ(MissesAfter([&] { std::swap(pictures_[0], pictures_[1]); }), 1);
  EXPECT_EQ(MissesOf(), 0);
}

TEST_F(PictureSimilarityTest, LoadedWordsAreToldApart) {
  const std::string one = TrainVocabulary(Ring(3), {}, {}).value(), other = TrainVocabulary(Ring(4), {}, {}).value();
  EXPECT_EQ(MissesOf(one), kPictures);
  EXPECT_EQ(MissesOf(one), 0);
  EXPECT_EQ(MissesOf(other), kPictures);
  EXPECT_EQ(Graph(one)->weight, RunSimilarity(features_, options_.similarity, context_, one)->weight);
  EXPECT_EQ(Graph("no vocabulary").status().code(), "bad_vocabulary");
}

TEST_F(PictureSimilarityTest, NothingIsKeptOfAPictureWithoutADigest) {
  pictures_[1].sha256 = "";
  EXPECT_EQ(MissesOf(), kPictures - 1);
  EXPECT_EQ(MissesOf(), 0);
}

TEST_F(PictureSimilarityTest, WhereEveryPairIsMatchedNothingIsCompared) {
  options_.clusters.exhaustive_max_images = kPictures;
  EXPECT_EQ(MissesOf(), 0);
  const SimilarityGraph compared = RunSimilarity(features_, options_.similarity, context_).value();
  const ViewClusters clusters = RunClusters(compared, options_.clusters, context_).value();
  const ViewClusters same = RunClusters(Graph().value(), options_.clusters, context_).value();
  EXPECT_EQ(same.clusters, clusters.clusters);
  EXPECT_EQ(same.pairs, clusters.pairs);
  EXPECT_EQ(Graph("no vocabulary").status().code(), "bad_vocabulary");
  features_.assign(kPictures, Features());
  EXPECT_EQ(Graph().status().code(), "no_features");
}

}  // namespace
}  // namespace drupe
