#include "reconstruction/dense/point_colours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

/// How bright a lamp above the camera makes a surface with this normal.
double Lit(const Eigen::Vector3d& normal_in_cam) {
  return 0.35 + 0.65 * std::max(0.0, normal_in_cam.dot(Eigen::Vector3d(0.2, -0.6, -0.77)));
}

/// A grey ball of radius 8 about the origin under that lamp, in one view from z = -50.
struct LitBall {
  DenseOptions options;
  DenseScene scene;
  LevelContext context;
  PointCloud cloud;

  LitBall() {
    constexpr double kBallRadius = 8, kGrey = 200;
    options.min_height_mm = -100;  // there is no board
    scene.options = &options;
    scene.typical_depth = 50;
    scene.neighbours.resize(1);
    DenseView view;
    view.centre = Eigen::Vector3d(0, 0, -50);
    view.cam_from_world.translation = -view.centre;
    view.camera = {200, 200, 49.5, 49.5};
    view.rgb = RgbImage(100, 100, 3);
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 100; ++x) {
        const Eigen::Vector3d ray = view.camera.Ray(x, y).normalized();
        const double along = -view.centre.dot(ray);
        const double chord2 = kBallRadius * kBallRadius - (view.centre.squaredNorm() - along * along);
        const Eigen::Vector3d hit = view.centre + ray * (along - std::sqrt(std::max(chord2, 0.0)));
        for (int c = 0; c < 3; ++c) view.rgb.At(x, y, c) = static_cast<std::uint8_t>(kGrey * Lit(hit.normalized()));
        if (chord2 < 0.3 * kBallRadius * kBallRadius) continue;  // the outline, where pixels mix
        cloud.positions.push_back(hit.cast<float>());
        cloud.normals.push_back(hit.normalized().cast<float>());
        cloud.view_counts.push_back(3);
      }
    }
    context.cameras.push_back(view.camera);
    scene.views.push_back(std::move(view));
    context.scene = &scene;
  }
};

std::pair<int, int> Range(const std::vector<Rgb>& colours) {
  std::pair<int, int> range{255, 0};
  for (const Rgb& colour : colours)
    range = {std::min<int>(range.first, colour[1]), std::max<int>(range.second, colour[1])};
  return range;
}

TEST(ColourPoints, ShadingIsTakenOutOfOneColourAndLeftInTheOther) {
  LitBall ball;
  ASSERT_GT(ball.cloud.size(), 1500u);
  const std::vector<PatchMap> maps = {PatchMap(0, 1, 100, 100, 0.01f)};
  const std::vector<int> owners(ball.cloud.size(), 0);
  ASSERT_TRUE(ColourPoints(ball.context, maps, owners, true, {}, &ball.cloud).ok());
  const auto [raw_low, raw_high] = Range(ball.cloud.raw_colours);
  const auto [low, high] = Range(ball.cloud.colours);
  EXPECT_GT(raw_high - raw_low, 60);
  EXPECT_LT(high - low, 20);
  for (std::size_t i = 0; i < ball.cloud.size(); i += 7) {
    EXPECT_NEAR(ball.cloud.raw_colours[i][1], 200 * Lit(ball.cloud.normals[i].cast<double>()), 2);
  }
}

TEST(ColourPoints, WithoutKnownLampsBothColoursAreAsPictured) {
  LitBall ball;
  const std::vector<PatchMap> maps = {PatchMap(0, 1, 100, 100, 0.01f)};
  ASSERT_TRUE(ColourPoints(ball.context, maps, std::vector<int>(ball.cloud.size(), 0), false, {}, &ball.cloud).ok());
  EXPECT_EQ(ball.cloud.colours, ball.cloud.raw_colours);
}

}  // namespace
}  // namespace drupe::dense
