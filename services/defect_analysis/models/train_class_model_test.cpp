#include "defect_analysis/models/train_class_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace drupe {
namespace {

using Reports = std::vector<std::vector<LabelledDefect>>;

struct Kind {
  DefectClass defect_class;
  double length, width, depth, lightness;
};
constexpr Kind kKinds[] = {{DefectClass::kRainSpot, 2, 1.9, 0, -15},
                           {DefectClass::kScar, 8, 1.5, 0, -3},
                           {DefectClass::kCrack, 9, 0.5, 0.2, -25},
                           {DefectClass::kDecay, 9, 8, 0.1, -22}};

LabelledDefect DefectLike(const Kind& kind, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, 1);
  Defect defect;
  defect.length_mm = kind.length * std::exp(0.12 * normal(random));
  defect.width_mm = std::min(defect.length_mm, kind.width * std::exp(0.12 * normal(random)));
  defect.area_mm2 = 0.785 * defect.length_mm * defect.width_mm;
  defect.roundness = defect.width_mm / defect.length_mm;
  defect.depth_mm = kind.depth + 0.02 * normal(random);
  defect.lab_change = {kind.lightness + 2 * normal(random), 8 + normal(random), normal(random)};
  return {FeaturesOf(defect), kind.defect_class};
}

Reports MakeReports(int reports, int kinds, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Reports made(static_cast<std::size_t>(reports));
  for (auto& report : made) {
    for (int k = 0; k < 2 * kinds; ++k) report.push_back(DefectLike(kKinds[k % kinds], random));
  }
  return made;
}

TEST(TrainClassModel, TellsSeparableClassesOfNewFruitApart) {
  const auto model = TrainClassModel(MakeReports(6, 4, 1), {});
  ASSERT_TRUE(model.ok()) << model.status().message();
  EXPECT_EQ(model->classes.size(), 4u);
  EXPECT_EQ(model->training.sum(), 48);
  EXPECT_EQ(model->training.trace(), 48);
  EXPECT_EQ(model->left_out.sum(), 48);
  EXPECT_GE(model->left_out.trace(), 47);
  int right = 0;
  for (const auto& report : MakeReports(25, 4, 2)) {
    for (const LabelledDefect& defect : report) {
      const Classification found = model->Classify(defect.features);
      right += found.defect_class == defect.defect_class ? 1 : 0;
      EXPECT_GE(found.confidence, 0.25);
      EXPECT_LE(found.confidence, 1);
    }
  }
  EXPECT_GE(right, 196);  // of 200
}

TEST(TrainClassModel, ReachesTheMinimumWhereProbabilitiesMatchCounts) {
  // At the best bias of an unpenalised model the probabilities of a class add up to its defects; here it nearly is.
  const Reports reports = MakeReports(5, 3, 3);
  const auto model = TrainClassModel(reports, {.ridge = 1});
  ASSERT_TRUE(model.ok());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(3);
  for (const auto& report : reports) {
    for (const LabelledDefect& defect : report) sum += model->Probabilities(defect.features);
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], 10, 0.01);
}

TEST(TrainClassModel, MoreRidgeIsLessSure) {
  const Reports reports = MakeReports(4, 2, 4);
  const auto bold = TrainClassModel(reports, {.ridge = 0.01});
  const auto shy = TrainClassModel(reports, {.ridge = 10});
  ASSERT_TRUE(bold.ok() && shy.ok());
  const ClassFeatures& features = reports[0][0].features;
  EXPECT_GT(bold->Classify(features).confidence, shy->Classify(features).confidence);
}

TEST(TrainClassModel, IsTheSameEveryTimeAndReadBack) {
  const auto once = TrainClassModel(MakeReports(3, 4, 5), {});
  const auto twice = TrainClassModel(MakeReports(3, 4, 5), {});
  ASSERT_TRUE(once.ok() && twice.ok());
  EXPECT_EQ(DumpJson(ToJson(*once)), DumpJson(ToJson(*twice)));
  const auto json = ParseJson(DumpJson(ToJson(*once)));
  ASSERT_TRUE(json.ok());
  const auto read = ParseClassModel(*json);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(DumpJson(ToJson(*read)), DumpJson(ToJson(*once)));
}

TEST(TrainClassModel, NeedsDefectsOfTwoClasses) {
  EXPECT_EQ(TrainClassModel({}, {}).status().code(), "no_defects");
  EXPECT_EQ(TrainClassModel({{}, {}}, {}).status().code(), "no_defects");
  EXPECT_EQ(TrainClassModel(MakeReports(3, 1, 6), {}).status().code(), "one_class");
  EXPECT_EQ(TrainClassModel(MakeReports(3, 2, 6), {.ridge = 0}).status().field(), "ridge");
  Reports broken = MakeReports(3, 2, 6);
  broken[0][0].features[2] = NAN;
  EXPECT_EQ(TrainClassModel(broken, {}).status().code(), "training_failed");
}

TEST(TrainClassModel, OneReportHasNothingLeftOut) {
  const auto model = TrainClassModel(MakeReports(1, 2, 7), {});
  ASSERT_TRUE(model.ok());
  EXPECT_EQ(model->left_out.sum(), 0);
  EXPECT_TRUE(ParseClassModel(ToJson(*model)).ok());
}

Report OneCrack() {
  Report report;
  report.scale_source = ScaleSource::kBoard;
  report.fruits.resize(2);
  report.fruits[1].defects.resize(1);
  Defect& crack = report.fruits[1].defects[0];
  crack.defect_class = DefectClass::kCrack;
  crack.area_mm2 = 4.5;
  crack.length_mm = 9;
  crack.width_mm = 0.5;
  crack.lab_change = {-20, 4, 1};
  return report;
}

TEST(ReadLabelledReport, TakesTheClassesAsTheyAre) {
  const auto defects = ReadLabelledReport(ToJson(OneCrack()));
  ASSERT_TRUE(defects.ok()) << defects.status().message();
  ASSERT_EQ(defects->size(), 1u);
  EXPECT_EQ(defects->front().defect_class, DefectClass::kCrack);
  EXPECT_TRUE(defects->front().features.isApprox(FeaturesOf(OneCrack().fruits[1].defects[0])));
}

TEST(ReadLabelledReport, RefusesHostileReportsByField) {
  const auto field_of = [](const char* pointer, Json value) {
    Json json = ToJson(OneCrack());
    json[Json::json_pointer(pointer)] = std::move(value);
    return ReadLabelledReport(json).status().field();
  };
  EXPECT_EQ(field_of("/fruits", 3), "fruits");
  EXPECT_EQ(field_of("/fruits/0", nullptr), "fruits[0].defects");
  EXPECT_EQ(field_of("/fruits/1/defects/0", 3), "fruits[1].defects[0]");
  EXPECT_EQ(field_of("/fruits/1/defects/0/class", "bruise"), "fruits[1].defects[0].class");
  EXPECT_EQ(field_of("/fruits/1/defects/0/class", "intact"), "fruits[1].defects[0].class");
  EXPECT_EQ(field_of("/fruits/1/defects/0/width_mm", nullptr), "fruits[1].defects[0].width_mm");
  EXPECT_EQ(field_of("/fruits/1/defects/0/area_mm2", 1e300), "fruits[1].defects[0].area_mm2");
  EXPECT_EQ(field_of("/fruits/1/defects/0/lab_change", Json{1, 2}), "fruits[1].defects[0].lab_change");
  Json unscaled = ToJson(OneCrack());
  unscaled["unit"] = nullptr;
  EXPECT_EQ(ReadLabelledReport(unscaled).status().code(), "no_scale");
  EXPECT_EQ(ReadLabelledReport(Json()).status().code(), "bad_report");
  EXPECT_EQ(ReadLabelledReport(Json::array()).status().code(), "bad_report");
}

}  // namespace
}  // namespace drupe
