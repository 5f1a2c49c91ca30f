#include "reconstruction/similarity/description.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "reconstruction/similarity/ring_of_looks.h"

namespace drupe {
namespace {

WordModel RingWords() {
  return TrainWords(Ring(12), {}, {}).value();
}

TEST(DescriptionTest, StepsGiveTheGraphOfTheStage) {
  const std::vector<Features> pictures = Ring(18);
  const SimilarityOptions options;
  const WordModel words = TrainWords(std::span(pictures).first(12), options, {}).value();
  std::vector<Description> descriptions;
  for (const Features& picture : pictures) descriptions.push_back(DescribePicture(picture, words, options));
  const SimilarityGraph steps = LinkDescriptions(descriptions), stage = RunSimilarity(pictures, options, {}).value();
  EXPECT_EQ(steps.fisher_distance, stage.fisher_distance);
  EXPECT_EQ(steps.weight, stage.weight);
}

TEST(DescriptionTest, HasNormOneOrZero) {
  const WordModel words = RingWords();
  EXPECT_NEAR(DescribePicture(Ring(12)[3], words, {}).norm(), 1, 1e-5);
  const Description blank = DescribePicture(Features(), words, {});
  EXPECT_EQ(blank.norm(), 0);
  EXPECT_EQ(DescriptionDistance(blank, DescribePicture(Ring(12)[3], words, {})), 2);
}

TEST(DescriptionTest, ReadsBackBitByBit) {
  const Description whole = DescribePicture(Ring(12)[3], RingWords(), {});
  EXPECT_LE(static_cast<std::size_t>(whole.size()), MaxDescriptionLength());
  const Description read = ReadDescription(WriteDescription(whole)).value();
  ASSERT_EQ(read.size(), whole.size());
  EXPECT_EQ(std::memcmp(read.data(), whole.data(), sizeof(float) * static_cast<std::size_t>(whole.size())), 0);
}

TEST(DescriptionTest, DamageIsSeen) {
  const std::string whole = WriteDescription(Description::Constant(3, 0.5f));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_EQ(ReadDescription(std::string_view(whole).substr(0, length)).status().code(), "bad_description") << length;
  }
  EXPECT_FALSE(ReadDescription(whole + "x").ok());
  EXPECT_FALSE(ReadDescription("DRPDESC2" + whole.substr(8)).ok());
  Description bad = Description::Constant(3, 0.5f);
  bad[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(ReadDescription(WriteDescription(bad)).ok());
}

TEST(DescriptionTest, MostAlikeOnARingAreTheNeighbours) {
  const std::vector<Features> pictures = Ring(18);
  const WordModel words = RingWords();
  std::vector<Description> descriptions;
  for (const Features& picture : pictures) descriptions.push_back(DescribePicture(picture, words, {}));
  const Description picture = descriptions[5];
  descriptions[5].setZero();  // as if it had no features
  std::vector<std::size_t> most = MostAlike(picture, descriptions, 2);
  std::sort(most.begin(), most.end());
  EXPECT_EQ(most, (std::vector<std::size_t>{4, 6}));
  EXPECT_EQ(MostAlike(picture, descriptions, 100).size(), 17u);
}

TEST(TrainingFrontTest, EndsWithThePictureThatMakesTheNumberFull) {
  SimilarityOptions options;
  options.training_images = 3;
  TrainingFront front(options);
  for (const Features& picture : Ring(2)) front.Add(picture);
  front.Add(Features());
  EXPECT_FALSE(front.IsComplete());
  EXPECT_EQ(front.size(), 3u);
  for (const Features& picture : Ring(6)) front.Add(picture);
  EXPECT_TRUE(front.IsComplete());
  EXPECT_EQ(front.size(), 4u);
}

TEST(TrainingFrontTest, NoughtIsAll) {
  SimilarityOptions options;
  options.training_images = 0;
  TrainingFront front(options);
  for (const Features& picture : Ring(30)) front.Add(picture);
  EXPECT_FALSE(front.IsComplete());
  EXPECT_EQ(front.size(), 30u);
}

TEST(TrainingFrontTest, LaterPicturesDoNotChangeTheWords) {
  const std::vector<Features> pictures = Ring(18);
  SimilarityOptions options;
  options.training_images = 8;
  const SimilarityGraph many = RunSimilarity(pictures, options, {}).value();
  const SimilarityGraph few = RunSimilarity(std::span(pictures).first(10), options, {}).value();
  for (int a = 0; a < 10; ++a) {
    for (int b = 0; b < 10; ++b) EXPECT_EQ(many.Distance(a, b), few.Distance(a, b));
  }
  options.training_images = 0;
  EXPECT_NE(RunSimilarity(pictures, options, {}).value().Distance(0, 1), many.Distance(0, 1));
}

TEST(TrainingFrontTest, BlankPicturesInFrontAreNoHindrance) {
  std::vector<Features> pictures(15);
  for (const Features& picture : Ring(18)) pictures.push_back(picture);
  const SimilarityGraph graph = RunSimilarity(pictures, {}, {}).value();
  for (int a = 0; a < 18; ++a) {
    EXPECT_LT(graph.Distance(15 + a, 15 + (a + 1) % 18), graph.Distance(15 + a, 15 + (a + 9) % 18));
  }
}

}  // namespace
}  // namespace drupe
