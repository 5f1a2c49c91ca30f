#include "scene/class_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace drupe {
namespace {

// Scars are longer than rain spots: log_elongation about 1, scale 0.5, speaks for them.
ClassModel SpotOrScar() {
  ClassModel model;
  model.name = "two";
  model.classes = {DefectClass::kRainSpot, DefectClass::kScar};
  model.mean[1] = 1;
  model.scale[1] = 0.5;
  model.weights.setZero(2, kClassFeatures);
  model.weights(1, 1) = 2;
  model.bias = Eigen::Vector2d(0, -0.25);
  model.reports = 3;
  model.training = ClassConfusion::Constant(2, 2, 5);
  model.left_out = ClassConfusion::Zero(2, 2);
  return model;
}

Defect Long(double elongation) {
  Defect defect;
  defect.area_mm2 = 4;
  defect.width_mm = 1.5;
  defect.length_mm = elongation * defect.width_mm;
  defect.depth_mm = -0.02;
  defect.lab_change = {-10, 5, 2};
  return defect;
}

TEST(FeaturesOf, TakesWhatTheReportStates) {
  const ClassFeatures features = FeaturesOf(Long(3));
  EXPECT_DOUBLE_EQ(features[0], std::log(4.0));
  EXPECT_DOUBLE_EQ(features[1], std::log(3.0));
  EXPECT_DOUBLE_EQ(features[3], 1.5);
  EXPECT_DOUBLE_EQ(features[4], -0.02);
  EXPECT_DOUBLE_EQ(features[7], 2);
  EXPECT_TRUE(FeaturesOf(Defect()).allFinite());
}

TEST(ClassModel, ConfidenceIsTheProbability) {
  const Classification found = SpotOrScar().Classify(FeaturesOf(Long(std::exp(1.5))));  // standardised 1
  EXPECT_EQ(found.defect_class, DefectClass::kScar);
  EXPECT_NEAR(found.confidence, 1 / (1 + std::exp(-1.75)), 1e-12);
  EXPECT_EQ(SpotOrScar().Classify(FeaturesOf(Long(1))).defect_class, DefectClass::kRainSpot);
}

TEST(ClassModel, FeaturesThatAreNoNumbersSayNothing) {
  ClassFeatures features = FeaturesOf(Long(9));
  features[1] = std::numeric_limits<double>::quiet_NaN();
  const Eigen::VectorXd probabilities = SpotOrScar().Probabilities(features);
  EXPECT_NEAR(probabilities.sum(), 1, 1e-12);
  EXPECT_NEAR(probabilities[0], 1 / (1 + std::exp(-0.25)), 1e-12);
}

TEST(ClassModel, ReadsWhatItWrote) {
  const Json json = ToJson(SpotOrScar());
  const Result<ClassModel> model = ParseClassModel(json);
  ASSERT_TRUE(model.ok()) << model.status().message();
  EXPECT_EQ(ToJson(*model), json);
}

TEST(ClassModel, RefusesHostileFilesByField) {
  const auto field_of = [](const char* pointer, Json value) {
    Json json = ToJson(SpotOrScar());
    json[Json::json_pointer(pointer)] = std::move(value);
    const Result<ClassModel> model = ParseClassModel(json);
    return model.ok() ? "" : model.status().field();
  };
  EXPECT_EQ(field_of("/format", "drupe-colour-model"), "format");
  EXPECT_EQ(field_of("/version", 2), "version");
  EXPECT_EQ(field_of("/name", "../x"), "name");
  EXPECT_EQ(field_of("/ridge", -1), "ridge");
  EXPECT_EQ(field_of("/reports", "3"), "reports");
  EXPECT_EQ(field_of("/features", Json::array()), "features");
  EXPECT_EQ(field_of("/features/0/name", "log_width"), "features");
  EXPECT_EQ(field_of("/features/2/scale", 0), "features.scale");
  EXPECT_EQ(field_of("/features/2/mean", nullptr), "features.mean");
  EXPECT_EQ(field_of("/classes", Json::array()), "classes");
  EXPECT_EQ(field_of("/classes/1/class", "rain_spot"), "classes");
  EXPECT_EQ(field_of("/classes/1/class", "intact"), "classes");
  EXPECT_EQ(field_of("/classes/1", 7), "classes");
  EXPECT_EQ(field_of("/classes/1/weights", Json{1, 2}), "classes.weights");
  EXPECT_EQ(field_of("/classes/1/weights/3", 1e30), "classes.weights");
  EXPECT_EQ(field_of("/classes/0/bias", "0"), "classes.bias");
  EXPECT_EQ(field_of("/confusion", nullptr), "confusion.training");
  EXPECT_EQ(field_of("/confusion/left_out/1", Json{1, 2, 3}), "confusion.left_out");
  EXPECT_EQ(field_of("/confusion/left_out/1/0", -1), "confusion.left_out");
  EXPECT_FALSE(ParseClassModel(Json::array()).ok());
  EXPECT_FALSE(ParseClassModel(Json()).ok());
}

}  // namespace
}  // namespace drupe
