#pragma once

#include <cstdint>
#include <vector>

#include "base/run_context.h"
#include "reconstruction/dense/level_context.h"
#include "reconstruction/dense/surface_fit.h"

namespace drupe::dense {

SurfaceFitSettings FitSettings(const DenseOptions& options, int radius);

/// The view's patches at the level of `context` from those of the level above; `wanted` as in PredictGuesses.
PatchMap RefineMap(const LevelContext& context, int view, const PatchMap& coarse,
                   const std::vector<std::uint8_t>& wanted, const RunContext& run);

/// The same at the finest level, smoothed. What comes out depends on the pictures of the view and of its neighbours and
/// on the coarse cells about the wanted ones, and on no other view's patches.
PatchMap RefineFinest(const LevelContext& context, int view, const PatchMap& coarse,
                      const std::vector<std::uint8_t>& wanted, const RunContext& run);

constexpr int kFinestFitRadius = 8;  ///< of that smoothing, in cells of the finest level

}  // namespace drupe::dense
