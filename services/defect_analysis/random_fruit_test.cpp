#include "scene/random_fruit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "defect_analysis/pipeline.h"

namespace drupe {
namespace {

const Defect* NearestTo(const Fruit& fruit, const TrueDefect& truth) {
  const auto away = [&](const Defect& defect) { return (defect.centre_mm - truth.centre_mm).norm(); };
  const auto nearest = std::min_element(fruit.defects.begin(), fruit.defects.end(),
                                        [&](const Defect& a, const Defect& b) { return away(a) < away(b); });
  return nearest == fruit.defects.end() || away(*nearest) > 0.8 ? nullptr : &*nearest;
}

// The short form of `drupe bench defects --fruits N`.
TEST(RunAnalysis, MeasuresRandomFruits) {
  int of = 0, found = 0, class_right = 0, covered = 0, reported = 0;
  for (std::uint64_t seed = 101; seed <= 103; ++seed) {
    RandomFruit fruit = MakeRandomFruit(seed, {.spacing_mm = 0.12, .touching_share = 0, .intact_share = 0});
    AnalysisInput input;
    input.cloud = std::move(fruit.cloud);
    input.scale_source = ScaleSource::kBoard;
    const auto report = RunAnalysis(input, {}, {});
    ASSERT_TRUE(report.ok());
    ASSERT_EQ(report->fruits.size(), 1u);
    const Fruit& measured = report->fruits[0];
    EXPECT_EQ(measured.grade, fruit.truth.grade) << "seed " << seed;
    EXPECT_NEAR(measured.volume_mm3 / fruit.truth.volume_mm3, 1, 0.015);
    EXPECT_NEAR(measured.surface_area_mm2 / fruit.truth.surface_area_mm2, 1, 0.015);
    EXPECT_NEAR(measured.equatorial_diameter_mm / fruit.truth.equatorial_diameter_mm, 1, 0.003);
    reported += static_cast<int>(measured.defects.size());
    for (const TrueDefect& truth : fruit.truth.defects) {
      ++of;
      const Defect* defect = NearestTo(measured, truth);
      if (defect == nullptr) continue;
      ++found;
      class_right += defect->defect_class == truth.defect_class ? 1 : 0;
      covered += std::abs(defect->area_mm2 - truth.area_mm2) <= 2 * defect->area_uncertainty_mm2 ? 1 : 0;
      EXPECT_NEAR(defect->area_mm2 / truth.area_mm2, 1, 0.08);
    }
  }
  ASSERT_GT(of, 0);
  EXPECT_EQ(found, of);
  EXPECT_EQ(reported, found);
  EXPECT_EQ(class_right, of);
  EXPECT_GE(covered, 0.8 * of);
}

// A scar 4.6 Lab units from its skin, below what the second look takes for a contrast.
TEST(RunAnalysis, FindsAFaintScarByItsRim) {
  RandomFruit fruit = MakeRandomFruit(12034, {.spacing_mm = 0.12});
  AnalysisInput input;
  input.cloud = std::move(fruit.cloud);
  input.scale_source = ScaleSource::kBoard;
  const auto report = RunAnalysis(input, {}, {});
  ASSERT_TRUE(report.ok());
  ASSERT_EQ(report->fruits.size(), 1u);
  EXPECT_EQ(report->fruits[0].defects.size(), fruit.truth.defects.size());
  EXPECT_EQ(report->fruits[0].grade, DefectClass::kScar);
  for (const TrueDefect& truth : fruit.truth.defects) {
    const Defect* defect = NearestTo(report->fruits[0], truth);
    ASSERT_NE(defect, nullptr);
    EXPECT_NEAR(defect->area_mm2 / truth.area_mm2, 1, 0.05);
  }
}

TEST(MakeRandomFruit, IsTheSameForTheSameSeed) {
  const RandomFruitOptions coarse{.spacing_mm = 0.4, .touching_share = 0.25, .intact_share = 0.15};
  const RandomFruit a = MakeRandomFruit(5, coarse), b = MakeRandomFruit(5, coarse), c = MakeRandomFruit(6, coarse);
  EXPECT_EQ(a.cloud.positions, b.cloud.positions);
  EXPECT_EQ(a.cloud.colours, b.cloud.colours);
  EXPECT_NE(a.truth.volume_mm3, c.truth.volume_mm3);
}

}  // namespace
}  // namespace drupe
