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

/// A surface of 5 x 5 mm pixels facing views 0, 1 and 2 that stand side by side, 50 before it.
struct Wall {
  DenseOptions options;
  DenseScene scene;
  LevelContext context;
  std::vector<PatchMap> maps;
  PointCloud cloud;

  Wall() {
    options.min_height_mm = -100;  // there is no board
    scene.options = &options;
    scene.typical_depth = 50;
    context.scene = &scene;
    for (int k = 0; k < 3; ++k) {
      DenseView view;
      view.centre = Eigen::Vector3d(2.0 * k, 0, -50);
      view.cam_from_world.translation = -view.centre;
      view.camera = {200, 200, 59.5, 49.5};
      view.rgb = RgbImage(128, 100, 3);
      context.cameras.push_back(view.camera);
      scene.views.push_back(std::move(view));
      scene.neighbours.push_back({(k + 1) % 3, (k + 2) % 3});
      maps.emplace_back(0, 4, 128, 100, 0.001f);
    }
    for (int y = 5; y < 95; ++y) {
      for (int x = 15; x < 105; ++x) {
        cloud.positions.emplace_back((x - 59.5f) / 4, (y - 49.5f) / 4, 0.0f);
        cloud.normals.emplace_back(-Eigen::Vector3f::UnitZ());
        cloud.view_counts.push_back(3);
      }
    }
  }

  /// Paints what view k shows: `grey(x, y)`, at world positions in mm.
  template <typename Grey>
  void Paint(int k, const Grey& grey) {
    RgbImage& picture = scene.views[k].rgb;
    for (int v = 0; v < picture.height(); ++v) {
      for (int u = 0; u < picture.width(); ++u) {
        const double x = (u - 59.5) / 4 + 2.0 * k, y = (v - 49.5) / 4;
        for (int c = 0; c < 3; ++c) picture.At(u, v, c) = static_cast<std::uint8_t>(grey(x, y));
      }
    }
  }

  /// Puts a patch that is nearer than the wall, at `depth`, into the cell of view k that shows (x, y).
  void PutBefore(int k, double x, double y, double depth) {
    const Eigen::Vector2d pixel = context.cameras[k].Pixel(Eigen::Vector3d(x, y, 0) - scene.views[k].centre);
    PatchCell& cell = maps[k].At(maps[k].CellOf(pixel.x()), maps[k].CellOf(pixel.y()));
    cell.w = static_cast<float>(1 / depth);
    cell.ncc = 0.9f;
  }

  /// The grey of the point nearest to (x, y), coloured with the lamps' doing left in.
  int ColourAt(double x, double y) {
    std::size_t nearest = 0;
    const Eigen::Vector3f place(static_cast<float>(x), static_cast<float>(y), 0);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if ((cloud.positions[i] - place).norm() < (cloud.positions[nearest] - place).norm()) nearest = i;
    }
    EXPECT_TRUE(ColourPoints(context, maps, std::vector<int>(cloud.size(), 0), false, {}, &cloud).ok());
    return cloud.colours[nearest][0];
  }
};

TEST(ColourPoints, AnOwnerFromWhichThePointIsHiddenHasNoSay) {
  Wall wall;
  wall.Paint(0, [](double, double) { return 180; });
  wall.Paint(1, [](double, double) { return 100; });
  wall.Paint(2, [](double, double) { return 104; });
  wall.PutBefore(0, 0, 0, 40);
  EXPECT_NEAR(wall.ColourAt(0, 0), 102, 3);
  EXPECT_NEAR(wall.ColourAt(8, 8), 102, 3);  // the median, where all see it
}

TEST(ColourPoints, NeitherHasAViewWithAnotherSurfacesEdgeBesideThePoint) {
  Wall wall;
  wall.Paint(0, [](double, double) { return 180; });
  wall.Paint(1, [](double, double) { return 176; });
  wall.Paint(2, [](double, double) { return 100; });
  for (const int view : {0, 1}) wall.PutBefore(view, 0.5, 0, 40);  // 2.5 pixels beside
  EXPECT_NEAR(wall.ColourAt(0, 0), 100, 3);
  EXPECT_NEAR(wall.ColourAt(-8, 8), 178, 3);
}

TEST(ColourPoints, AShadowThatSomeViewsHaveMakesNoMosaic) {
  Wall wall;
  // Right of x = 0 view 1 stands in a shade, and every other column of half a millimetre glares in the other two.
  const auto glares = [](double x) { return x > 0 && static_cast<int>(2 * x) % 2 == 0; };
  for (const int view : {0, 2}) {
    wall.Paint(view, [&](double x, double) { return glares(x) ? 255 : 160; });
  }
  wall.Paint(1, [](double x, double) { return x > 0 ? 128 : 160; });
  const std::vector<int> owners(wall.cloud.size(), 0);
  ASSERT_TRUE(ColourPoints(wall.context, wall.maps, owners, true, {}, &wall.cloud).ok());
  std::pair<int, int> right{255, 0};
  for (std::size_t i = 0; i < wall.cloud.size(); ++i) {
    const double x = wall.cloud.positions[i].x(), column = std::fmod(2 * x, 1.0);
    if (x < 4 || x > 9 || column < 0.3 || column > 0.7) continue;  // clear of the columns' borders
    right = {std::min<int>(right.first, wall.cloud.colours[i][1]),
             std::max<int>(right.second, wall.cloud.colours[i][1])};
  }
  EXPECT_LT(right.second - right.first, 6);
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
