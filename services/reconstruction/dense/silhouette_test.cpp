#include "reconstruction/dense/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/dense/synthetic_scene.h"

namespace drupe::dense {
namespace {

/// The views of a scene with their whole pictures.
std::vector<DenseView> ViewsOf(const SyntheticScene& scene) {
  std::vector<DenseView> views(scene.pictures.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].index = static_cast<int>(i);
    views[i].cam_from_world = *scene.model.views[i].cam_from_world;
    views[i].centre = views[i].cam_from_world.Centre();
    BuildPyramid(scene.pictures[i], scene.model.camera, {0, 0, scene.model.camera.width, scene.model.camera.height}, 1,
                 &views[i]);
  }
  return views;
}

TEST(Silhouette, IsWhatReachesTheRim) {
  SyntheticScene scene = MakeBallScene();
  const RegionOfInterest everywhere;
  for (int y = 95; y < 105; ++y) {  // a spot of the background's colour on the ball
    for (int x = 115; x < 125; ++x) {
      for (int c = 0; c < 3; ++c) scene.pictures[0].At(x, y, c) = scene.pictures[0].At(2, 2, c);
    }
  }
  const std::vector<DenseView> views = ViewsOf(scene);
  const auto silhouettes = FindSilhouettes(scene.model, everywhere, views);
  EXPECT_TRUE(silhouettes[0].IsBackground(5, 5));
  EXPECT_TRUE(silhouettes[0].IsBackground(235, 100));
  EXPECT_FALSE(silhouettes[0].IsBackground(120, 100));
  EXPECT_FALSE(silhouettes[0].IsBackground(90, 100));
  EXPECT_FALSE(silhouettes[0].IsBackground(-3, 100));
}

TEST(Silhouette, PointsBesideTheBallAreOutsideItsHull) {
  const SyntheticScene scene = MakeBallScene();
  const std::vector<DenseView> views = ViewsOf(scene);
  const auto silhouettes = FindSilhouettes(scene.model, {}, views);
  EXPECT_FALSE(IsOutsideHull(views, silhouettes, kBallCentre));
  EXPECT_FALSE(IsOutsideHull(views, silhouettes, kBallCentre + Eigen::Vector3d(12, 0, 0)));
  EXPECT_TRUE(IsOutsideHull(views, silhouettes, kBallCentre + Eigen::Vector3d(18, 0, 0)));
  EXPECT_TRUE(IsOutsideHull(views, silhouettes, kBallCentre + Eigen::Vector3d(0, 0, 18)));
}

/// The ball before black cloth, on a sheet of cloth with folds that hold texture: in all pictures the lower left of the
/// frame, from the rim on, is grey of `level` and below.
SyntheticScene BallOnDarkCloth(double level) {
  SyntheticScene scene = MakeBallScene();
  for (RgbImage& picture : scene.pictures) {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const bool ball = picture.At(x, y, 1) > 40, sheet = y > 150;
        if (ball) continue;
        const double fold = 0.8 + 0.2 * std::sin(0.9 * x) * std::sin(0.7 * y);
        for (int c = 0; c < 3; ++c) picture.At(x, y, c) = static_cast<std::uint8_t>(sheet ? level * fold : 3);
      }
    }
  }
  const std::size_t tracks = scene.model.tracks.size();
  for (std::size_t i = 0; i < tracks; ++i) {  // features of the folds: half as many as the ball has
    Track track = scene.model.tracks[i];
    track.position.z() = 5;
    track.position.head<2>() *= 1.5;
    if (i % 2 == 0) scene.model.tracks.push_back(track);
  }
  return scene;
}

TEST(Silhouette, LeavesOutDarkClothThoughItHasTexture) {
  const SyntheticScene dark = BallOnDarkCloth(26), grey = BallOnDarkCloth(90);
  const auto of_dark = FindSilhouettes(dark.model, {}, ViewsOf(dark));
  const auto of_grey = FindSilhouettes(grey.model, {}, ViewsOf(grey));
  EXPECT_TRUE(of_dark[0].IsBackground(120, 5));
  EXPECT_TRUE(of_dark[0].IsBackground(120, 190));
  EXPECT_FALSE(of_dark[0].IsBackground(120, 100));
  EXPECT_FALSE(of_grey[0].IsBackground(120, 190));  // may be an object as well
}

TEST(Silhouette, IsNothingWhereTheRimLooksLikeTheScene) {
  SyntheticScene scene = MakeBallScene();
  scene.pictures = Render(scene.model, [](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    return std::optional<Eigen::Vector3d>(origin + direction * 95);  // texture everywhere
  });
  const std::vector<DenseView> views = ViewsOf(scene);
  EXPECT_TRUE(BackgroundColours::Learn(scene.model, {}, views).Empty());
  const auto silhouettes = FindSilhouettes(scene.model, {}, views);
  EXPECT_FALSE(silhouettes[0].IsBackground(2, 2));
  EXPECT_FALSE(IsOutsideHull(views, silhouettes, kBallCentre + Eigen::Vector3d(30, 0, 0)));
}

}  // namespace
}  // namespace drupe::dense
