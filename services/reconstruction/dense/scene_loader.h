#pragma once

#include "reconstruction/dense/level_context.h"

namespace drupe::dense {

/// The levels of a run, coarsest first.
struct LevelPlan {
  int coarsest = 0;
  int finest = 0;
};

/// Of the stage's progress, reported by LoadScene.
constexpr double kLoadedShare = 0.15;

/// Finds the region, loads the part of every registered view that shows it, builds the pyramids and chooses neighbours
/// and levels within the options' limits. Errors: as RunDense.
Result<DenseScene> LoadScene(const DenseInput& input, const DenseOptions& options, const RunContext& run,
                             LevelPlan* plan);

}  // namespace drupe::dense
