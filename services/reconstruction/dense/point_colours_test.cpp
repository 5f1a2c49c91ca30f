#include "reconstruction/dense/point_colours.h"

#include <gtest/gtest.h>

namespace drupe::dense {
namespace {

using Rgb = Eigen::Matrix<std::uint8_t, 3, 1>;

RgbImage Flat(const Rgb& colour) {
  RgbImage picture(20, 20, 3);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      for (int c = 0; c < 3; ++c) picture.At(x, y, c) = colour[c];
    }
  }
  return picture;
}

// A point at the origin, owned by view 0, and views side by side before it, each a picture of one colour.
Rgb ColourOfPoint(const std::vector<Rgb>& pictures, std::uint8_t view_count) {
  DenseScene scene;
  scene.typical_depth = 50;
  LevelContext context;
  context.scene = &scene;
  std::vector<PatchMap> maps;
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    DenseView view;
    view.centre = Eigen::Vector3d(2.0 * static_cast<double>(k), 0, -50);
    view.cam_from_world.translation = -view.centre;
    view.camera = {100, 100, 9.5, 9.5};
    view.rgb = Flat(pictures[k]);
    context.cameras.push_back(view.camera);
    scene.views.push_back(std::move(view));
    scene.neighbours.emplace_back();
    if (k > 0) scene.neighbours[0].push_back(static_cast<int>(k));
    maps.emplace_back(0, 1, 20, 20, 0.01f);
  }
  PointCloud cloud;
  cloud.positions = {Eigen::Vector3f::Zero()};
  cloud.normals = {-Eigen::Vector3f::UnitZ()};
  cloud.view_counts = {view_count};
  EXPECT_TRUE(ColourPoints(context, maps, {0}, false, {}, &cloud).ok());
  return cloud.colours[0];
}

const Rgb kSkin(100, 150, 50), kGloss(200, 220, 190);

TEST(ColourPoints, AnOwnerThatNoViewAgreedWithHasNoSay) {
  EXPECT_EQ(ColourOfPoint({kGloss, kSkin}, 1), kSkin);
  EXPECT_EQ(ColourOfPoint({kGloss}, 1), kGloss);  // unless it is alone
}

TEST(ColourPoints, HighlightsAreLeftOut) {
  EXPECT_EQ(ColourOfPoint({kGloss, kSkin, kSkin}, 3), kSkin);
}

TEST(ColourPoints, AMatchedOwnerCounts) {
  EXPECT_EQ(ColourOfPoint({kSkin, kGloss}, 2), kSkin);
}

}  // namespace
}  // namespace drupe::dense
