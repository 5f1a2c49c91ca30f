#include "reconstruction/dense/dense.h"

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "reconstruction/dense/cloud_assembly.h"
#include "reconstruction/dense/epipolar_seeds.h"
#include "reconstruction/dense/exchange.h"
#include "reconstruction/dense/expansion.h"
#include "reconstruction/dense/point_colours.h"
#include "reconstruction/dense/prediction.h"
#include "reconstruction/dense/progress_span.h"
#include "reconstruction/dense/scene_loader.h"
#include "reconstruction/dense/surface_fit.h"
#include "reconstruction/dense/visibility.h"

namespace drupe {

namespace dense {

namespace {

constexpr int kCoarseCsize = 2;          ///< of all levels above the finest
constexpr float kSeedSlopeSigma = 0.5f;  ///< pixels of parallax a pixel: seeds know little of the normal
constexpr float kRefineSlopeSigma = 0.05f;
constexpr float kLeastPriorSigma = 0.03f, kLargestPriorSigma = 1.0f;  ///< pixels of parallax
constexpr int kFitRadius = 5;                                         ///< cells of a level above the finest
constexpr int kFinestFitRadius = 8;                                   ///< cells of the finest level
constexpr int kFitMargin = kFinestFitRadius / kCoarseCsize / 2;       ///< that radius in cells of the level above

// The stage's progress after the steps, about their shares of the time.
constexpr double kGrownShare = 0.2, kCoarseShare = 0.4;

/// One level's state: what it is about and the patches of all views.
struct LevelState {
  LevelContext context;
  std::vector<PatchMap> maps;
};

SurfaceFitSettings FitSettings(const DenseOptions& options, int radius) {
  SurfaceFitSettings settings;
  settings.radius = radius;
  settings.window_px = static_cast<float>(options.wsize);
  return settings;
}

Status SmoothMaps(const RunContext& run, const SurfaceFitSettings& settings, std::vector<PatchMap>* maps) {
  return ParallelFor(run, maps->size(),
                     [&](std::size_t view) { (*maps)[view] = FitSurface((*maps)[view], settings, run.cancelled); });
}

/// What every level above the finest goes through after its patches were found.
Status Consolidate(const RunContext& run, LevelState* state) {
  DRUPE_RETURN_IF_ERROR(ExchangePatches(state->context, run, &state->maps));
  DRUPE_RETURN_IF_ERROR(FilterByVisibility(state->context, run, &state->maps));
  DRUPE_RETURN_IF_ERROR(BorrowFromNeighbours(state->context, run, &state->maps));
  return SmoothMaps(run, FitSettings(*state->context.scene->options, kFitRadius), &state->maps);
}

Result<LevelState> GrowCoarsest(const DenseScene& scene, int level, const RunContext& run) {
  LevelState state{MakeLevelContext(scene, level, kCoarseCsize), std::vector<PatchMap>(scene.views.size())};
  std::vector<std::vector<Eigen::Vector2i>> corners(state.maps.size());
  if (scene.options->epipolar_seeds) {
    DRUPE_RETURN_IF_ERROR(ParallelFor(run, corners.size(), [&](std::size_t i) {
      corners[i] = FindCorners(state.context.frames[i].reference, state.context.settings.half + 1);
    }));
  }
  ProgressSpan progress(run, kLoadedShare, kGrownShare, static_cast<double>(state.maps.size()));
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, state.maps.size(), [&](std::size_t i) {
    const int view = static_cast<int>(i);
    PatchMap map = state.context.EmptyMap(view);
    PlaceGuesses(state.context, view, SeedGuesses(state.context, view, map), kSeedSlopeSigma, run.cancelled, &map);
    if (scene.options->epipolar_seeds) {
      PlaceGuesses(state.context, view, EpipolarGuesses(state.context, view, corners, map), kSeedSlopeSigma,
                   run.cancelled, &map);
    }
    Expand(state.context, view, run.cancelled, &map);
    state.maps[i] = std::move(map);
    progress.Add(1);
  }));
  DRUPE_RETURN_IF_ERROR(Consolidate(run, &state));
  return state;
}

/// The view's patches at the level of `context` from those of the level above; `wanted` as in PredictGuesses.
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

/// The level below `coarse`, refined and grown further. `from` and `to` are its part of the stage's progress.
Result<LevelState> RefineWhole(const LevelState& coarse, double from, double to, const RunContext& run) {
  LevelState state{MakeLevelContext(*coarse.context.scene, coarse.context.level - 1, kCoarseCsize),
                   std::vector<PatchMap>(coarse.maps.size())};
  ProgressSpan progress(run, from, to, static_cast<double>(state.maps.size()));
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, state.maps.size(), [&](std::size_t i) {
    const int view = static_cast<int>(i);
    state.maps[i] = RefineMap(state.context, view, coarse.maps[i], {}, run);
    Expand(state.context, view, run.cancelled, &state.maps[i]);
    progress.Add(1);
  }));
  DRUPE_RETURN_IF_ERROR(Consolidate(run, &state));
  return state;
}

std::int64_t CountOwned(const std::vector<std::uint8_t>& flags) {
  return std::count(flags.begin(), flags.end(), 1);
}

/// The least csize >= the option's for which the owned cells stay within max_points.
int FinestCsize(const LevelState& coarse, std::int64_t cells) {
  const DenseOptions& options = *coarse.context.scene->options;
  const std::int64_t pixels = cells * (2 * kCoarseCsize) * (2 * kCoarseCsize);
  int csize = options.csize;
  while (csize < 16 && pixels / (csize * csize) > options.max_points) ++csize;
  return csize;
}

/// The points of the finest level, which each view refines only where it owns the surface.
Result<AssembledCloud> RefineOwned(const LevelState& coarse, const RunContext& run) {
  const DenseScene& scene = *coarse.context.scene;
  std::vector<std::vector<std::uint8_t>> owned(coarse.maps.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, owned.size(), [&](std::size_t view) {
    owned[view] = OwnedCells(coarse.context, static_cast<int>(view), coarse.maps, -kSeamOverlap, kFitMargin);
  }));
  std::int64_t cells = 0;
  for (const auto& flags : owned) cells += CountOwned(flags);
  const LevelContext fine = MakeLevelContext(scene, coarse.context.level - 1, FinestCsize(coarse, cells));
  ProgressSpan progress(run, kCoarseShare, kAssembledShare, static_cast<double>(cells));
  const auto fine_map = [&](int view) {
    const PatchMap map = RefineMap(fine, view, coarse.maps[view], owned[view], run);
    PatchMap fitted = FitSurface(map, FitSettings(*scene.options, kFinestFitRadius), run.cancelled);
    progress.Add(static_cast<double>(CountOwned(owned[view])));
    return fitted;
  };
  return AssembleCloud(fine, fine_map, coarse.context, coarse.maps, run);
}

Result<PointCloud> Reconstruct(const DenseInput& input, const DenseOptions& options, const RunContext& run) {
  LevelPlan plan;
  DRUPE_ASSIGN_OR_RETURN(const DenseScene scene, LoadScene(input, options, run, &plan));
  DRUPE_ASSIGN_OR_RETURN(LevelState coarse, GrowCoarsest(scene, plan.coarsest, run));
  double share = kGrownShare;
  while (coarse.context.level > plan.finest + 1) {
    // Every level has four times the pixels of the one above it.
    const double next = kCoarseShare - (kCoarseShare - share) * (coarse.context.level > plan.finest + 2 ? 0.75 : 0);
    DRUPE_ASSIGN_OR_RETURN(coarse, RefineWhole(coarse, share, next, run));
    share = next;
  }
  DRUPE_ASSIGN_OR_RETURN(AssembledCloud assembled, RefineOwned(coarse, run));
  if (assembled.cloud.empty()) {
    return Unprocessable("no_dense_points", "no surface was found on which enough pictures agree");
  }
  const bool lamps_stand_still = input.model->scale_source == ScaleSource::kBoard;
  DRUPE_RETURN_IF_ERROR(
      ColourPoints(coarse.context, coarse.maps, assembled.owners, lamps_stand_still, run, &assembled.cloud));
  run.Report("dense", 1.0);
  return std::move(assembled.cloud);
}

}  // namespace

}  // namespace dense

Result<PointCloud> RunDense(const DenseInput& input, const DenseOptions& options, const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  try {
    return dense::Reconstruct(input, options, context);
  } catch (const std::exception& error) {
    return Internal("internal", std::string("dense reconstruction: ") + error.what());
  }
}

}  // namespace drupe
