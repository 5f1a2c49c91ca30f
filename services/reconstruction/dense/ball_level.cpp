#include "reconstruction/dense/ball_level.h"

#include <cmath>

namespace drupe::dense {

namespace {

std::unique_ptr<BallLevel> Load() {
  auto ball = std::make_unique<BallLevel>();
  ball->scene = MakeBallScene();
  const DenseInput input{&ball->scene.model,
                         [&](int view) -> Result<RgbImage> { return ball->scene.pictures[view].Clone(); }};
  LevelPlan plan;
  ball->loaded = LoadScene(input, ball->options, {}, &plan).value();
  ball->context = MakeLevelContext(ball->loaded, 0, 2);
  return ball;
}

}  // namespace

const BallLevel& BallLevel::Get() {
  static const std::unique_ptr<BallLevel> ball = Load();
  return *ball;
}

BallLevel::Filled BallLevel::Count(int view, const PatchMap& map) const {
  Filled filled;
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      if (!map.At(col, row).Filled()) continue;
      const SurfaceElement element =
          ToWorld(loaded.views[view], context.cameras[view], map.Pixel(col), map.Pixel(row), map.At(col, row));
      ++filled.all;
      filled.right += std::abs((element.position - kBallCentre).norm() - kBallRadius) < 0.3 ? 1 : 0;
    }
  }
  return filled;
}

}  // namespace drupe::dense
