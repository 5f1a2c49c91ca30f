#pragma once

#include <memory>
#include <vector>

#include "reconstruction/dense/scene_loader.h"
#include "reconstruction/dense/synthetic_scene.h"

namespace drupe::dense {

/// The ball of MakeBallScene() loaded, at the finest level of its pyramid with cells of two pixels, for tests of single
/// steps.
struct BallLevel {
  SyntheticScene scene;
  DenseOptions options;
  DenseScene loaded;
  LevelContext context;

  /// Loaded once, and the same for all tests.
  static const BallLevel& Get();

  /// Filled cells of a view's map, and those of them that lie within 0.3 mm of the ball.
  struct Filled {
    int all = 0;
    int right = 0;
  };
  Filled Count(int view, const PatchMap& map) const;
};

}  // namespace drupe::dense
