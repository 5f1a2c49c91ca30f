#include "reconstruction/dense/epipolar_seeds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reconstruction/dense/scene_loader.h"
#include "reconstruction/dense/synthetic_scene.h"

namespace drupe::dense {
namespace {

const Eigen::Vector3d kBallCentre(0, 0, 25);
constexpr double kRadius = 12;

TEST(EpipolarSeeds, FindSurfaceWithoutTracks) {
  const SyntheticScene scene = MakeBallScene();
  const DenseInput input{&scene.model, [&](int view) -> Result<RgbImage> { return scene.pictures[view].Clone(); }};
  const DenseOptions options;
  LevelPlan plan;
  const Result<DenseScene> loaded = LoadScene(input, options, {}, &plan);
  ASSERT_TRUE(loaded.ok());
  const LevelContext context = MakeLevelContext(*loaded, 0, 2);
  std::vector<std::vector<Eigen::Vector2i>> corners;
  for (const RefinerFrame& frame : context.frames) corners.push_back(FindCorners(frame.reference, 4));
  EXPECT_GT(corners[0].size(), 20u);
  PatchMap map = context.EmptyMap(0);
  const std::vector<PatchGuess> guesses = EpipolarGuesses(context, 0, corners, map);
  ASSERT_GT(guesses.size(), 50u);
  PlaceGuesses(context, 0, guesses, 0.5f, {}, &map);
  int placed = 0, right = 0;
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      if (!map.At(col, row).Filled()) continue;
      const SurfaceElement element =
          ToWorld(loaded->views[0], context.cameras[0], map.Pixel(col), map.Pixel(row), map.At(col, row));
      ++placed;
      right += std::abs((element.position - kBallCentre).norm() - kRadius) < 0.3 ? 1 : 0;
    }
  }
  EXPECT_GT(placed, 15);
  EXPECT_GT(right, 0.8 * placed);
}

TEST(EpipolarSeeds, LeaveAloneWhatHasPatches) {
  const SyntheticScene scene = MakeBallScene();
  const DenseInput input{&scene.model, [&](int view) -> Result<RgbImage> { return scene.pictures[view].Clone(); }};
  const DenseOptions options;
  LevelPlan plan;
  const Result<DenseScene> loaded = LoadScene(input, options, {}, &plan);
  ASSERT_TRUE(loaded.ok());
  const LevelContext context = MakeLevelContext(*loaded, 0, 2);
  std::vector<std::vector<Eigen::Vector2i>> corners;
  for (const RefinerFrame& frame : context.frames) corners.push_back(FindCorners(frame.reference, 4));
  PatchMap map = context.EmptyMap(0);
  for (PatchCell& cell : map.cells) cell.ncc = 0.9f;
  EXPECT_TRUE(EpipolarGuesses(context, 0, corners, map).empty());
}

}  // namespace
}  // namespace drupe::dense
