#include "reconstruction/pipeline_options.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

TEST(ReconstructionOptions, WhatIsWrittenReadsBackTheSame) {
  ReconstructionOptions options;
  options.features.first_octave = 1;
  options.dense.scene = DenseOptions::Scene::kAll;
  options.dense.csize = 3;
  options.matching.max_ratio = 0.65;
  options.cycles.max_rotation_deg = 7;
  options.sparse.method = SparseMethod::kWhole;
  options.sparse.adjustment = AdjustmentMethod::kMonolithic;
  options.run_dense = false;
  const auto read = ParseReconstructionOptions(ToJson(options));
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(DumpJson(ToJson(*read)), DumpJson(ToJson(options)));
  EXPECT_NE(DumpJson(ToJson(*read)), DumpJson(ToJson(ReconstructionOptions())));
}

TEST(ReconstructionOptions, TrainingImagesAreReadAndChecked) {
  const auto few = ParseReconstructionOptions(*ParseJson(R"({"similarity": {"training_images": 5}})"));
  ASSERT_TRUE(few.ok());
  EXPECT_EQ(few->similarity.training_images, 5);
  EXPECT_EQ(ToJson(*few)["similarity"]["training_images"], 5);
  EXPECT_TRUE(ParseReconstructionOptions(*ParseJson(R"({"similarity": {"training_images": 0}})")).ok());
  const auto negative = ParseReconstructionOptions(*ParseJson(R"({"similarity": {"training_images": -1}})"));
  EXPECT_EQ(negative.status().field(), "similarity.training_images");
}

TEST(ReconstructionOptions, NullAndEmptyGiveTheDefaults) {
  for (const Json& json : {Json(nullptr), Json::object()}) {
    const auto read = ParseReconstructionOptions(json);
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(DumpJson(ToJson(*read)), DumpJson(ToJson(ReconstructionOptions())));
  }
}

TEST(ReconstructionOptions, MistakesAreNamedWithTheirPath) {
  const std::pair<const char*, const char*> cases[] = {
      {R"({"dens": {}})", "options.dens"},
      {R"({"dense": {"levle": 1}})", "options.dense.levle"},
      {R"({"dense": {"scene": "board"}})", "options.dense.scene"},
      {R"({"matching": {"max_ratio": "high"}})", "options.matching.max_ratio"},
      {R"({"sparse": 7})", "options.sparse"},
      {R"({"sparse": {"method": "parts"}})", "options.sparse.method"},
      {R"({"sparse": {"adjustment": true}})", "options.sparse.adjustment"},
  };
  for (const auto& [text, field] : cases) {
    const auto read = ParseReconstructionOptions(*ParseJson(text));
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_EQ(read.status().field(), field);
    EXPECT_EQ(read.status().kind(), StatusKind::kInvalidArgument);
  }
}

TEST(ReconstructionOptions, ValuesOutOfRangeAreRefused) {
  EXPECT_FALSE(ParseReconstructionOptions(*ParseJson(R"({"dense": {"max_points": -5}})")).ok());
  EXPECT_FALSE(ParseReconstructionOptions(*ParseJson(R"({"matching": {"max_ratio": 2}})")).ok());
  const auto features = ParseReconstructionOptions(*ParseJson(R"({"features": {"max_features": 0}})"));
  ASSERT_FALSE(features.ok());
  EXPECT_EQ(features.status().code(), "invalid_option");
  EXPECT_EQ(features.status().field(), "features.max_features");
}

}  // namespace
}  // namespace drupe
