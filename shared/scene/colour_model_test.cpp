#include "scene/colour_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace drupe {
namespace {

ColourModel TwoVectors() {
  ColourModel model;
  model.name = "two";
  model.space = ColourSpace::kRgb;
  model.mean = {100, 100, 100};
  model.scale = {50, 50, 50};
  model.gamma = 0.5f;
  model.bias = -0.25f;
  model.vectors = {{0, 1, 0}, {0, 0, 0}};
  model.weights = {2, -1};
  model.training.Count(true, true);
  model.training.Count(true, false);
  model.training.Count(false, false);
  return model;
}

TEST(ColourModel, DecidesBySumOfKernels) {
  const float expected = -0.25f + 2 - std::exp(-0.5f);
  EXPECT_NEAR(TwoVectors().Decide(Rgb8(100, 150, 100)), expected, 1e-6);
  EXPECT_LT(TwoVectors().Decide(Rgb8(100, 0, 100)), 0);
}

TEST(ColourModel, ErrorsAreSharesOfTheirOwnClass) {
  const ConfusionTable table = TwoVectors().training;
  EXPECT_DOUBLE_EQ(table.FruitError(), 0.5);
  EXPECT_DOUBLE_EQ(table.BackgroundError(), 0);
  EXPECT_DOUBLE_EQ(table.Accuracy(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(ConfusionTable().Accuracy(), 0);
}

TEST(ColourModel, ReadsWhatItWrote) {
  const Json json = ToJson(TwoVectors());
  const Result<ColourModel> model = ParseColourModel(json);
  ASSERT_TRUE(model.ok()) << model.status().message();
  EXPECT_EQ(ToJson(*model), json);
}

TEST(ColourModel, RefusesHostileFilesByField) {
  const auto field_of = [](const char* pointer, Json value) {
    Json json = ToJson(TwoVectors());
    json[Json::json_pointer(pointer)] = std::move(value);
    const Result<ColourModel> model = ParseColourModel(json);
    return model.ok() ? "" : model.status().field();
  };
  EXPECT_EQ(field_of("/format", "other"), "format");
  EXPECT_EQ(field_of("/version", 2), "version");
  EXPECT_EQ(field_of("/name", "../x"), "name");
  EXPECT_EQ(field_of("/gamma", -1), "gamma");
  EXPECT_EQ(field_of("/gamma", "1"), "gamma");
  EXPECT_EQ(field_of("/normalisation/scale", Json{1, 0, 1}), "normalisation.scale");
  EXPECT_EQ(field_of("/support_vectors", Json::array()), "support_vectors");
  EXPECT_EQ(field_of("/support_vectors/1", Json{0, 0, 0}), "support_vectors");
  EXPECT_EQ(field_of("/support_vectors/1/3", 1e30), "support_vectors");
  EXPECT_EQ(field_of("/confusion", nullptr), "confusion.training.fruit_as_fruit");
  EXPECT_FALSE(ParseColourModel(Json::array()).ok());
  EXPECT_FALSE(ParseColourModel(Json()).ok());
}

}  // namespace
}  // namespace drupe
