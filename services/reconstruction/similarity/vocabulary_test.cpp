#include "reconstruction/similarity/vocabulary.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "base/digest.h"
#include "reconstruction/similarity/ring_of_looks.h"
#include "reconstruction/similarity/word_model.h"

namespace drupe {
namespace {

constexpr std::size_t kDigestBytes = 64;

/// Few words, so that every byte of the file can be tried.
SimilarityOptions Small() {
  SimilarityOptions options;
  options.gaussians = 2;
  options.pca_dimensions = 1;
  return options;
}

std::string Trained(const SimilarityOptions& options) {
  return TrainVocabulary(Ring(6), options, {}).value();
}

/// The digest at the end made right again, as somebody who means harm would.
std::string Resealed(std::string bytes) {
  bytes.resize(bytes.size() - kDigestBytes);
  return bytes + Sha256Hex(bytes);
}

TEST(VocabularyTest, LoadedGivesTheGraphOfTheTrained) {
  const std::vector<Features> pictures = Ring(12);
  const std::string vocabulary = TrainVocabulary(pictures, {}, {}).value();
  EXPECT_LE(vocabulary.size(), MaxVocabularyBytes());
  const auto trained = RunSimilarity(pictures, {}, {}), loaded = RunSimilarity(pictures, {}, {}, vocabulary);
  ASSERT_TRUE(trained.ok() && loaded.ok());
  EXPECT_EQ(trained->weight, loaded->weight);
  EXPECT_EQ(trained->fisher_distance, loaded->fisher_distance);
}

TEST(VocabularyTest, TrainedElsewhereStillTellsNeighbours) {
  const std::vector<Features> pictures = Ring(18);
  const std::string vocabulary = TrainVocabulary(std::span(pictures).first(9), {}, {}).value();
  const auto graph = RunSimilarity(pictures, {}, {}, vocabulary);
  ASSERT_TRUE(graph.ok());
  for (int a = 0; a < 18; ++a) EXPECT_LT(graph->Distance(a, (a + 1) % 18), graph->Distance(a, (a + 9) % 18));
}

TEST(VocabularyTest, ReadsBackBitByBit) {
  const std::string bytes = Trained({});
  EXPECT_EQ(WriteWords(ReadWords(bytes).value()), bytes);
}

TEST(VocabularyTest, EveryCutIsSeen) {
  const std::string whole = Trained(Small());
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_EQ(ReadWords(std::string_view(whole).substr(0, length)).status().code(), "bad_vocabulary") << length;
  }
  EXPECT_FALSE(ReadWords(whole + "x").ok());
}

TEST(VocabularyTest, EveryChangedByteIsSeen) {
  const std::string whole = Trained(Small());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_FALSE(ReadWords(damaged).ok()) << i;
  }
}

TEST(VocabularyTest, LiesWithARightDigestAreSeen) {
  const std::string whole = Trained(Small());
  for (const std::uint32_t lie : {0u, 129u, 0xFFFFFFFFu}) {
    for (const std::size_t at : {8, 12}) {
      std::string bytes = whole;
      std::memcpy(bytes.data() + at, &lie, sizeof(lie));
      EXPECT_EQ(ReadWords(Resealed(bytes)).status().code(), "bad_vocabulary");
    }
  }
  // The last float is a variance.
  for (const float lie : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + bytes.size() - kDigestBytes - sizeof(lie), &lie, sizeof(lie));
    EXPECT_EQ(ReadWords(Resealed(bytes)).status().code(), "bad_vocabulary");
  }
}

TEST(VocabularyTest, NoFeaturesTrainNothing) {
  EXPECT_EQ(TrainVocabulary(std::vector<Features>(3), {}, {}).status().code(), "no_features");
}

}  // namespace
}  // namespace drupe
