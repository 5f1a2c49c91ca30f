#include "defect_analysis/report/assemble.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

Defect DefectOf(DefectClass defect_class, double area) {
  Defect defect;
  defect.defect_class = defect_class;
  defect.area_mm2 = area;
  defect.perimeter_mm = 4;
  defect.contour_mm = {Eigen::Vector3d(1, 2, 3)};
  return defect;
}

Fruit Traits() {
  Fruit fruit;
  fruit.surface_area_mm2 = 4000;
  fruit.volume_mm3 = 24000;
  return fruit;
}

TEST(AssembleFruit, GradeIsTheWorstClass) {
  const Fruit fruit = AssembleFruit(
      Traits(),
      {DefectOf(DefectClass::kRainSpot, 4), DefectOf(DefectClass::kCrack, 2), DefectOf(DefectClass::kScar, 9)}, 1);
  EXPECT_EQ(fruit.grade, DefectClass::kCrack);
  EXPECT_DOUBLE_EQ(fruit.defects[0].area_share_pct, 0.1);
  EXPECT_DOUBLE_EQ(fruit.defect_area_pct, 0.375);
}

TEST(AssembleFruit, WithoutDefectsIsIntact) {
  const Fruit fruit = AssembleFruit(Traits(), {}, 1);
  EXPECT_EQ(fruit.grade, DefectClass::kIntact);
  EXPECT_EQ(fruit.defect_area_pct, 0);
}

TEST(AssembleFruit, LengthsReturnToTheModelsUnit) {
  const Fruit fruit = AssembleFruit(Traits(), {DefectOf(DefectClass::kRainSpot, 4)}, 10);
  EXPECT_DOUBLE_EQ(fruit.surface_area_mm2, 40);
  EXPECT_DOUBLE_EQ(fruit.volume_mm3, 24);
  EXPECT_DOUBLE_EQ(fruit.defects[0].area_mm2, 0.04);
  EXPECT_DOUBLE_EQ(fruit.defects[0].perimeter_mm, 0.4);
  EXPECT_DOUBLE_EQ(fruit.defects[0].contour_mm[0].z(), 0.3);
  EXPECT_DOUBLE_EQ(fruit.defects[0].area_share_pct, 0.1);  // shares have no unit
}

}  // namespace
}  // namespace drupe
