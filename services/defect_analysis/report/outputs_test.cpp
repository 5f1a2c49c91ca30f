#include <gtest/gtest.h>

#include "defect_analysis/report/defects_ply.h"
#include "defect_analysis/report/observations.h"
#include "defect_analysis/report/trait_uncertainty.h"
#include "scene/ply.h"

namespace drupe {
namespace {

// A fruit of radius 10 mm about the origin with a square scar of 2 mm on top.
Fruit ScarredFruit() {
  Defect scar;
  scar.id = 1;
  scar.defect_class = DefectClass::kScar;
  scar.centre_mm = {0, 0, 10};
  scar.normal = Eigen::Vector3d::UnitZ();
  scar.area_mm2 = 4;
  scar.contour_mm = {{-1, -1, 9.9}, {1, -1, 9.9}, {1, 1, 9.9}, {-1, 1, 9.9}};
  Fruit fruit;
  fruit.id = 1;
  fruit.grade = DefectClass::kScar;
  fruit.equatorial_diameter_mm = fruit.polar_diameter_mm = 20;
  fruit.volume_mm3 = 4188.79;
  fruit.defects = {scar};
  return fruit;
}

TEST(DefectsPly, ColoursWhatLiesInAContour) {
  PointCloud cloud;
  cloud.positions = {{0.5f, 0.5f, 10}, {5, 0, 8.6f}, {0.5f, 0.5f, -10}, {40, 0, 0}};
  cloud.colours.assign(4, Rgb8(100, 150, 50));
  const auto read = ReadPly(DefectsPly(cloud, {ScarredFruit()}));
  ASSERT_TRUE(read.ok());
  ASSERT_EQ(read->size(), 4u + 3u);  // the contour, and the points on the fruit
  EXPECT_EQ(read->colours[0], Rgb8(255, 255, 255));
  EXPECT_EQ(read->colours[4], ClassColour(DefectClass::kScar));
  EXPECT_EQ(read->colours[5], Rgb8(112, 112, 112));
  EXPECT_EQ(read->colours[6], Rgb8(112, 112, 112));  // the other side of the fruit
}

TEST(ObservationsJson, HasTheFieldsOfAnObservation) {
  Report report;
  report.scale_source = ScaleSource::kBoard;
  report.fruits = {ScarredFruit()};
  const Json json = ObservationsJson(report);
  const Json& area = json["observations"]["fruit_1_defect_1"]["area_mm2"];
  EXPECT_EQ(area["trait"], "area");
  EXPECT_EQ(area["scale"], "mm2");
  EXPECT_EQ(area["value"], 4.0);
  EXPECT_EQ(json["observations"]["fruit_1"]["grade"]["value"], "scar");
  EXPECT_EQ(json["observations"]["fruit_1"]["equatorial_diameter_mm"]["value"], 20.0);
}

TEST(ObservationsJson, WithoutScaleLengthsAreLeftOut) {
  Report report;
  report.fruits = {ScarredFruit()};
  const Json json = ObservationsJson(report);
  EXPECT_FALSE(json["observations"]["fruit_1"].contains("volume_mm3"));
  EXPECT_TRUE(json["observations"]["fruit_1"].contains("sphericity"));
}

TEST(AddTraitUncertainties, GrowWithWhatIsUnseenAndWithTheScale) {
  FruitCloud cloud;
  cloud.surface =
      FruitSurface(Eigen::Vector3d::Zero(), CubeTable<float>::Of(16, [](const Eigen::Vector3d&) { return 10.0f; }));
  cloud.noise_mm = 0.02;
  cloud.observed_share = 0.8;
  Fruit fruit = ScarredFruit(), unsure = fruit, unseen = fruit;
  AddTraitUncertainties(cloud, 0, fruit);
  AddTraitUncertainties(cloud, 0.01, unsure);
  cloud.observed_share = 0.5;
  AddTraitUncertainties(cloud, 0, unseen);
  EXPECT_NEAR(fruit.equatorial_uncertainty_mm, 20 * 0.0004, 1e-4);
  EXPECT_NEAR(fruit.volume_uncertainty_mm3 / fruit.volume_mm3, std::hypot(0.0012, 0.003), 5e-5);
  EXPECT_GT(unsure.volume_uncertainty_mm3, 0.03 * fruit.volume_mm3);
  EXPECT_GT(unseen.volume_uncertainty_mm3, 2 * fruit.volume_uncertainty_mm3);
  EXPECT_EQ(unseen.equatorial_uncertainty_mm, fruit.equatorial_uncertainty_mm);
}

}  // namespace
}  // namespace drupe
