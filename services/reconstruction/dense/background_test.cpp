#include "reconstruction/dense/background.h"

#include <gtest/gtest.h>

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

const Eigen::Vector3d kBallCentre(0, 0, 25);

TEST(Background, IsWhatReachesTheRim) {
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

TEST(Background, PointsBesideTheBallAreOutsideItsHull) {
  const SyntheticScene scene = MakeBallScene();
  const std::vector<DenseView> views = ViewsOf(scene);
  const auto silhouettes = FindSilhouettes(scene.model, {}, views);
  EXPECT_FALSE(IsOutsideHull(views, silhouettes, kBallCentre));
  EXPECT_FALSE(IsOutsideHull(views, silhouettes, kBallCentre + Eigen::Vector3d(12, 0, 0)));
  EXPECT_TRUE(IsOutsideHull(views, silhouettes, kBallCentre + Eigen::Vector3d(18, 0, 0)));
  EXPECT_TRUE(IsOutsideHull(views, silhouettes, kBallCentre + Eigen::Vector3d(0, 0, 18)));
}

TEST(Background, IsNothingWhereTheRimLooksLikeTheScene) {
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
