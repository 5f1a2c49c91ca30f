#include "defect_analysis/report/defect_pictures.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "defect_analysis/report/defects_ply.h"
#include "defect_analysis/report/drawing.h"
#include "image/decode.h"
#include "image/encode.h"

namespace drupe {
namespace {

// A camera 200 mm away on the side of `towards`, looking at the origin.
View ViewFrom(const Eigen::Vector3d& towards) {
  const Eigen::Vector3d z = -towards.normalized(), x = Eigen::Vector3d::UnitZ().cross(z).normalized();
  View view;
  view.cam_from_world = Rigid3();
  view.cam_from_world->rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  view.cam_from_world->translation = Eigen::Vector3d(0, 0, 200);
  view.image = "0.png";
  return view;
}

// One fruit of radius 15 mm with a square defect towards +x, seen from -x, +x and +y.
SparseModel Model() {
  SparseModel model;
  model.camera.width = 320;
  model.camera.height = 240;
  model.camera.fx = model.camera.fy = 1200;
  model.camera.cx = 159.5;
  model.camera.cy = 119.5;
  model.views = {ViewFrom(-Eigen::Vector3d::UnitX()), ViewFrom(Eigen::Vector3d::UnitX()),
                 ViewFrom(Eigen::Vector3d::UnitY())};
  return model;
}

std::vector<Fruit> Fruits() {
  Defect defect;
  defect.id = 2;
  defect.defect_class = DefectClass::kCrack;
  defect.centre_mm = {15, 0, 0};
  defect.normal = Eigen::Vector3d::UnitX();
  defect.area_mm2 = 36;
  defect.contour_mm = {{15, -3, -3}, {15, 3, -3}, {15, 3, 3}, {15, -3, 3}};
  Fruit fruit;
  fruit.id = 1;
  fruit.equatorial_diameter_mm = 30;
  fruit.defects = {defect};
  return {fruit};
}

TEST(BestView, IsTheOneThatFacesTheDefect) {
  EXPECT_EQ(BestView(Fruits()[0].defects[0], 0, Fruits(), Model()), 1);
}

TEST(BestView, IsNotHiddenByAnotherFruit) {
  std::vector<Fruit> fruits = Fruits();
  Fruit other;
  other.centre_mm = {60, 0, 0};
  other.equatorial_diameter_mm = 30;
  fruits.push_back(other);
  SparseModel model = Model();
  EXPECT_EQ(BestView(fruits[0].defects[0], 0, fruits, model), -1);
  model.views.push_back(ViewFrom({1, 1, 0}));
  EXPECT_EQ(BestView(fruits[0].defects[0], 0, fruits, model), 3);
}

TEST(DrawDefects, DrawsTheContourIntoTheCutOut) {
  const auto photographs = [](std::size_t view) -> Result<std::string> {
    EXPECT_EQ(view, 1u);
    return EncodePng(Canvas(320, 240, Rgb8(90, 140, 60)));
  };
  const auto pictures = DrawDefects(Fruits(), Model(), photographs);
  ASSERT_TRUE(pictures.ok());
  ASSERT_TRUE(pictures->files.contains("defect_1_2.png"));
  const auto tile = DecodeRgb(pictures->files.at("defect_1_2.png"));
  ASSERT_TRUE(tile.ok());
  EXPECT_EQ(tile->At(120, 120, 1), 140);  // the skin in the middle
  int red = 0;
  for (int x = 0; x < tile->width(); ++x) red += tile->At(x, 120, 0) > 200 && tile->At(x, 120, 1) < 80 ? 1 : 0;
  EXPECT_GE(red, 2);  // the row crosses the crack's red contour twice
  EXPECT_TRUE(DecodeRgb(pictures->files.at("contact_sheet.png")).ok());
}

TEST(DrawDefects, LeavesOutWhatNoPhotographShows) {
  const auto missing = [](std::size_t) -> Result<std::string> { return NotFound("image_not_found", "gone"); };
  const auto pictures = DrawDefects(Fruits(), Model(), missing);
  ASSERT_TRUE(pictures.ok());
  EXPECT_EQ(pictures->files.size(), 1u);  // the sheet alone
  std::vector<Fruit> intact = Fruits();
  intact[0].defects.clear();
  const auto sheet = DrawDefects(intact, Model(), missing)->files.at("contact_sheet.png");
  EXPECT_NE(sheet, pictures->files.at("contact_sheet.png")) << "which must not say that there are no defects";
}

}  // namespace
}  // namespace drupe
