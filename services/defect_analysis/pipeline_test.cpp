#include "defect_analysis/pipeline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "image/colour.h"
#include "scene/synthetic_fruit.h"

namespace drupe {
namespace {

AnalysisInput InputOf(const std::vector<SyntheticFruit>& fruits) {
  AnalysisInput input;
  input.scale_source = ScaleSource::kBoard;
  for (const SyntheticFruit& fruit : fruits) {
    fruit.AddTo(input.cloud);
    SyntheticFruit::AddBoardAndNeedle(fruit.centre, input.cloud);
  }
  return input;
}

SyntheticFruit SpottedFruit() {
  SyntheticFruit fruit;
  fruit.points = 160000;
  fruit.spots = {{Eigen::Vector3d(1, 0.2, 0.1).normalized(), 1.4},
                 {Eigen::Vector3d(-0.3, 1, 0.6).normalized(), 0.9},
                 {Eigen::Vector3d(-0.7, -0.6, -0.2).normalized(), 0.7},
                 {Eigen::Vector3d(0.1, -0.1, 1).normalized(), 1.1}};
  return fruit;
}

TEST(RunAnalysis, SpotsOfKnownAreaAreMeasuredToOnePercent) {
  const SyntheticFruit fruit = SpottedFruit();
  const auto report = RunAnalysis(InputOf({fruit}), {}, {});
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  ASSERT_EQ(report->fruits.size(), 1u);
  ASSERT_EQ(report->fruits[0].defects.size(), fruit.spots.size());
  EXPECT_EQ(report->fruits[0].grade, DefectClass::kRainSpot);
  const std::vector<std::size_t> by_area = {0, 3, 1, 2};
  for (std::size_t k = 0; k < by_area.size(); ++k) {
    const SyntheticFruit::Spot& spot = fruit.spots[by_area[k]];
    const Defect& defect = report->fruits[0].defects[k];
    EXPECT_EQ(defect.defect_class, DefectClass::kRainSpot);
    EXPECT_NEAR(defect.area_mm2 / fruit.SpotArea(spot), 1, 0.015) << "radius " << spot.radius_mm;
    EXPECT_LT((defect.centre_mm - (fruit.centre + 18 * spot.direction)).norm(), 0.05);
    EXPECT_GT(defect.normal.dot(spot.direction), 0.999);
    EXPECT_NEAR(defect.perimeter_mm, 2 * 3.14159265 * spot.radius_mm, 0.02 * defect.perimeter_mm);
    EXPECT_GT(defect.roundness, 0.97);
    EXPECT_LT(std::abs(defect.area_mm2 - fruit.SpotArea(spot)), 3 * defect.area_uncertainty_mm2);
  }
}

// Takes out the points within `half_width` mm of the plane through the fruit's centre with this normal.
void CutGap(const SyntheticFruit& fruit, const Eigen::Vector3d& normal, double half_width, PointCloud& cloud) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double away = normal.dot(cloud.positions[i].cast<double>() - fruit.centre);
    if (std::abs(away) < half_width) continue;
    cloud.positions[kept] = cloud.positions[i];
    cloud.colours[kept++] = cloud.colours[i];
  }
  cloud.positions.resize(kept);
  cloud.colours.resize(kept);
  cloud.normals.clear();
}

TEST(RunAnalysis, SpotAcrossAGapIsOneDefect) {
  SyntheticFruit fruit = SpottedFruit();
  fruit.spots.resize(1);
  AnalysisInput input = InputOf({fruit});
  CutGap(fruit, fruit.spots[0].direction.unitOrthogonal(), 0.4, input.cloud);
  const auto report = RunAnalysis(input, {}, {});
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->fruits.size(), 1u);
  ASSERT_EQ(report->fruits[0].defects.size(), 1u);
  EXPECT_EQ(report->fruits[0].defects[0].defect_class, DefectClass::kRainSpot);
  EXPECT_NEAR(report->fruits[0].defects[0].area_mm2 / fruit.SpotArea(fruit.spots[0]), 1, 0.04);
}

TEST(RunAnalysis, GlossIsNoDefect) {
  SyntheticFruit fruit = SpottedFruit();
  fruit.spots[0].srgb = Eigen::Vector3d(189, 204, 149);  // the skin's light and a quarter of white's
  const auto report = RunAnalysis(InputOf({fruit}), {}, {});
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->fruits[0].defects.size(), fruit.spots.size() - 1);
}

TEST(RunAnalysis, IntactFruitHasNoDefects) {
  SyntheticFruit fruit;
  fruit.polar_mm = 16;
  const auto report = RunAnalysis(InputOf({fruit}), {}, {});
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->fruits.size(), 1u);
  EXPECT_EQ(report->fruits[0].grade, DefectClass::kIntact);
  EXPECT_TRUE(report->fruits[0].defects.empty());
  EXPECT_NEAR(report->fruits[0].volume_mm3 / fruit.Volume(), 1, 0.01);
  EXPECT_NEAR(report->fruits[0].equatorial_diameter_mm, 36, 0.1);
  EXPECT_NEAR(report->fruits[0].polar_diameter_mm, 32, 0.5);  // the underside is closed, not seen
}

// Takes whatever is darker than the skin for a scar.
ClassModel DarkIsScar() {
  ClassModel model;
  model.name = "dark";
  model.classes = {DefectClass::kRainSpot, DefectClass::kScar};
  model.weights.setZero(2, kClassFeatures);
  model.weights(1, 5) = -1;  // of change_l
  model.bias = Eigen::Vector2d(0, 0);
  model.training = model.left_out = ClassConfusion::Zero(2, 2);
  return model;
}

TEST(RunAnalysis, ATrainedModelTakesTheRulesPlace) {
  SyntheticFruit fruit = SpottedFruit();
  fruit.points = 40000;
  AnalysisOptions options;
  options.defects.classes.model = DarkIsScar();
  const auto report = RunAnalysis(InputOf({fruit}), options, {});
  ASSERT_TRUE(report.ok()) << report.status().ToString();
  ASSERT_EQ(report->fruits.size(), 1u);
  EXPECT_EQ(report->fruits[0].grade, DefectClass::kScar);
  ASSERT_EQ(report->fruits[0].defects.size(), fruit.spots.size());
  for (const Defect& defect : report->fruits[0].defects) {
    EXPECT_EQ(defect.defect_class, DefectClass::kScar);
    EXPECT_NEAR(defect.confidence, 1 / (1 + std::exp(defect.lab_change[0])), 1e-9);
  }
  EXPECT_EQ(report->provenance.options["class"]["model"], ToJson(DarkIsScar()));
}

TEST(RunAnalysis, SeveralFruitsAreReportedApart) {
  SyntheticFruit left = SpottedFruit(), right;
  left.points = right.points = 50000;
  left.centre.x() = -24;
  right.centre.x() = 24;
  const auto report = RunAnalysis(InputOf({left, right}), {}, {});
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->fruits.size(), 2u);
  for (const Fruit& fruit : report->fruits) {
    EXPECT_EQ(fruit.defects.size(), fruit.centre_mm.x() < 0 ? left.spots.size() : 0u);
  }
}

TEST(RunAnalysis, WithoutScaleSharesAreTheSame) {
  const SyntheticFruit fruit = SpottedFruit();
  AnalysisInput input = InputOf({fruit});
  const auto metric = RunAnalysis(input, {}, {});
  for (Eigen::Vector3f& x : input.cloud.positions) x *= 0.01f;
  input.scale_source = ScaleSource::kNone;
  input.camera_centres = {{0, 2, 3}, {2, 0, 3}};
  const auto free = RunAnalysis(input, {}, {});
  ASSERT_TRUE(metric.ok() && free.ok());
  ASSERT_EQ(free->fruits.size(), 1u);
  ASSERT_EQ(free->fruits[0].defects.size(), fruit.spots.size());
  EXPECT_NEAR(free->fruits[0].surface_area_mm2 / metric->fruits[0].surface_area_mm2, 1e-4, 1e-6);
  EXPECT_NEAR(free->fruits[0].defect_area_pct, metric->fruits[0].defect_area_pct, 0.02);
}

TEST(RunAnalysis, ResultDoesNotDependOnThreads) {
  SyntheticFruit fruit = SpottedFruit();
  fruit.points = 40000;
  RunContext one, many;
  one.threads = 1;
  many.threads = 7;
  const auto a = RunAnalysis(InputOf({fruit}), {}, one);
  const auto b = RunAnalysis(InputOf({fruit}), {}, many);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(DumpJson(ToJson(*a)["fruits"]), DumpJson(ToJson(*b)["fruits"]));
}

TEST(RunAnalysis, SceneWithoutFruitGivesNone) {
  AnalysisInput input;
  SyntheticFruit::AddBoardAndNeedle({0, 0, 34}, input.cloud);
  const auto report = RunAnalysis(input, {}, {});
  ASSERT_TRUE(report.ok());
  EXPECT_TRUE(report->fruits.empty());
}

TEST(RunAnalysis, BadCloudsAreRefused) {
  AnalysisInput input;
  EXPECT_EQ(RunAnalysis(input, {}, {}).status().code(), "empty_cloud");
  input.cloud.positions.assign(10, Eigen::Vector3f::Zero());
  EXPECT_EQ(RunAnalysis(input, {}, {}).status().code(), "invalid_cloud");
  input.cloud.positions.assign(10, Eigen::Vector3f::Constant(std::nanf("")));
  input.cloud.colours.assign(10, Rgb8::Zero());
  EXPECT_EQ(RunAnalysis(input, {}, {}).status().code(), "invalid_cloud");
}

TEST(RunAnalysis, StraysAndNonFinitePointsDoNoHarm) {
  const SyntheticFruit fruit = SpottedFruit();
  AnalysisInput input = InputOf({fruit});
  for (int k = 0; k < 300; ++k) {
    input.cloud.positions.push_back(k % 3 == 0 ? Eigen::Vector3f::Constant(std::nanf(""))
                                               : Eigen::Vector3f(1e30f, static_cast<float>(k), -1e20f));
    input.cloud.colours.push_back(Rgb8::Zero());
  }
  const auto report = RunAnalysis(input, {}, {});
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->fruits.size(), 1u);
  EXPECT_EQ(report->fruits[0].defects.size(), fruit.spots.size());
}

TEST(RunAnalysis, StopsWhenCancelled) {
  RunContext context;
  context.cancelled = [] { return true; };
  EXPECT_EQ(RunAnalysis(InputOf({SyntheticFruit()}), {}, context).status().kind(), StatusKind::kCancelled);
}

TEST(ParseAnalysisOptions, ReadsAndWritesEveryKey) {
  AnalysisOptions options;
  options.defects.contour.control_points = 24;
  options.fruit.voxel_mm = 1.5;
  const auto read = ParseAnalysisOptions(ToJson(options));
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(DumpJson(ToJson(*read)), DumpJson(ToJson(options)));
}

TEST(ParseAnalysisOptions, ReadsAClassifierInline) {
  const auto read = ParseAnalysisOptions(Json{{"class", {{"model", ToJson(DarkIsScar())}, {"elongated_min", 3}}}});
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  ASSERT_TRUE(read->defects.classes.model.has_value());
  EXPECT_EQ(ToJson(*read)["class"]["model"], ToJson(DarkIsScar()));
  const auto rules = ParseAnalysisOptions(Json{{"class", {{"model", "rules"}}}});
  ASSERT_TRUE(rules.ok());
  EXPECT_FALSE(rules->defects.classes.model.has_value());
  EXPECT_EQ(ToJson(AnalysisOptions())["class"]["model"], "rules");
}

TEST(ParseAnalysisOptions, RefusesABadClassifier) {
  Json model = ToJson(DarkIsScar());
  model["classes"][1]["weights"][2] = 1e30;
  const auto huge = ParseAnalysisOptions(Json{{"class", {{"model", model}}}});
  EXPECT_EQ(huge.status().code(), "invalid_model");
  EXPECT_EQ(huge.status().field(), "options.class.model.classes.weights");
  EXPECT_EQ(ParseAnalysisOptions(Json{{"class", {{"model", "svm"}}}}).status().field(), "class.model");
  EXPECT_EQ(ParseAnalysisOptions(Json{{"class", {{"model", 7}}}}).status().field(), "options.class.model");
}

TEST(ParseAnalysisOptions, NamesWhatIsWrong) {
  const auto unknown = ParseAnalysisOptions(Json{{"contour", {{"points", 3}}}});
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.status().code(), "unknown_option");
  EXPECT_EQ(unknown.status().field(), "options.contour.points");
  const auto range = ParseAnalysisOptions(Json{{"plane", {{"iterations", 0}}}});
  ASSERT_FALSE(range.ok());
  EXPECT_EQ(range.status().code(), "invalid_option");
  EXPECT_FALSE(ParseAnalysisOptions(Json{{"colours", 3}}).ok());
  EXPECT_TRUE(ParseAnalysisOptions(Json()).ok());
}

}  // namespace
}  // namespace drupe
