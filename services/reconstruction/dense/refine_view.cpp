#include "reconstruction/dense/refine_view.h"

#include <algorithm>

#include "reconstruction/dense/expansion.h"
#include "reconstruction/dense/prediction.h"

namespace drupe::dense {

namespace {

constexpr float kRefineSlopeSigma = 0.05f;
constexpr float kLeastPriorSigma = 0.03f, kLargestPriorSigma = 1.0f;  ///< pixels of parallax

}  // namespace

SurfaceFitSettings FitSettings(const DenseOptions& options, int radius) {
  SurfaceFitSettings settings;
  settings.radius = radius;
  settings.window_px = static_cast<float>(options.wsize);
  return settings;
}

PatchMap RefineMap(const LevelContext& context, int view, const PatchMap& coarse,
                   const std::vector<std::uint8_t>& wanted, const RunContext& run) {
  PatchMap map = context.EmptyMap(view);
  std::vector<PatchGuess> guesses = PredictGuesses(coarse, wanted, map);
  const auto window_px = static_cast<float>(context.scene->options->wsize);
  for (PatchGuess& guess : guesses) {
    guess.plane.w += PlaneBias(guess.plane, window_px);  // as this level's planes will lie
    guess.plane.sigma = std::clamp(guess.plane.sigma, kLeastPriorSigma, kLargestPriorSigma);
  }
  PlaceGuesses(context, view, guesses, kRefineSlopeSigma, run.cancelled, &map);
  KeepGuesses(guesses, &map);
  return map;
}

PatchMap RefineFinest(const LevelContext& context, int view, const PatchMap& coarse,
                      const std::vector<std::uint8_t>& wanted, const RunContext& run) {
  const PatchMap map = RefineMap(context, view, coarse, wanted, run);
  return FitSurface(map, FitSettings(*context.scene->options, kFinestFitRadius), run.cancelled);
}

}  // namespace drupe::dense
