#include "reconstruction/dense/dense.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "reconstruction/dense/cloud_assembly.h"
#include "reconstruction/dense/dense_part.h"
#include "reconstruction/dense/epipolar_seeds.h"
#include "reconstruction/dense/exchange.h"
#include "reconstruction/dense/expansion.h"
#include "reconstruction/dense/part_file.h"
#include "reconstruction/dense/point_colours.h"
#include "reconstruction/dense/progress_span.h"
#include "reconstruction/dense/refine_view.h"
#include "reconstruction/dense/scene_loader.h"
#include "reconstruction/dense/visibility.h"

namespace drupe {

namespace dense {

namespace {

constexpr int kCoarseCsize = 2;          ///< of all levels above the finest
constexpr float kSeedSlopeSigma = 0.5f;  ///< pixels of parallax a pixel: seeds know little of the normal
constexpr int kFitRadius = 5;            ///< cells of a level above the finest
constexpr int kFitMargin = kFinestFitRadius / kCoarseCsize / 2;  ///< that radius in cells of the level above

// The stage's progress after the steps, about their shares of the time.
constexpr double kGrownShare = 0.2, kCoarseShare = 0.4;

/// One level's state: what it is about and the patches of all views.
struct LevelState {
  LevelContext context;
  std::vector<PatchMap> maps;
};

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

/// The finest level, before it is refined.
struct FinestLevel {
  LevelContext context;
  std::vector<std::vector<std::uint8_t>> owned;  ///< per view, cells of the level above
  std::int64_t cells = 0;                        ///< that are owned
};

Result<FinestLevel> PlanFinest(const LevelState& coarse, const RunContext& run) {
  FinestLevel finest;
  finest.owned.resize(coarse.maps.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, finest.owned.size(), [&](std::size_t view) {
    finest.owned[view] = OwnedCells(coarse.context, static_cast<int>(view), coarse.maps, -kSeamOverlap, kFitMargin);
  }));
  for (const auto& flags : finest.owned) finest.cells += CountOwned(flags);
  finest.context = MakeLevelContext(*coarse.context.scene, coarse.context.level - 1, FinestCsize(coarse, finest.cells));
  return finest;
}

/// The views in `count` groups of neighbouring ones, as even as can be.
std::vector<std::vector<ViewWork>> GroupViews(const FinestLevel& finest, const LevelState& coarse, std::size_t count) {
  std::vector<std::vector<ViewWork>> groups(std::min(count, coarse.maps.size()));
  for (std::size_t view = 0; view < coarse.maps.size(); ++view) {
    groups[view * groups.size() / coarse.maps.size()].push_back(
        {static_cast<int>(view), &coarse.maps[view], &finest.owned[view]});
  }
  return groups;
}

/// The finest maps by view, from parts that other machines may have done.
using FinestMaps = std::function<Result<PatchMap>(int view)>;
Result<FinestMaps> RefineInParts(const FinestLevel& finest, const LevelState& coarse, const DenseInput& input,
                                 const RunContext& run, ProgressSpan& progress) {
  const DenseOptions& options = *coarse.context.scene->options;
  const auto groups = GroupViews(finest, coarse, static_cast<std::size_t>(options.parts));
  StageParts parts;
  parts.stage = "dense";
  for (const auto& group : groups) parts.parts.push_back(WritePart(finest.context, group));
  parts.here = [&](std::size_t part) { return RefineViews(finest.context, groups[part], run); };
  parts.done = [&](std::size_t part) {
    for (const ViewWork& work : groups[part]) progress.Add(static_cast<double>(CountOwned(*work.wanted)));
  };
  DRUPE_ASSIGN_OR_RETURN(std::vector<std::string> results, input.run_parts(parts));
  auto read = std::make_shared<std::vector<PartResult>>();
  std::vector<std::pair<std::size_t, std::size_t>> place(coarse.maps.size());
  for (std::size_t part = 0; part < groups.size(); ++part) {
    DRUPE_ASSIGN_OR_RETURN(PartResult result, PartResult::Read(std::move(results[part]), groups[part].size()));
    read->push_back(std::move(result));
    for (std::size_t k = 0; k < groups[part].size(); ++k) place[groups[part][k].view] = {part, k};
  }
  return FinestMaps([read, place, &finest](int view) {
    const auto [part, k] = place[view];
    return (*read)[part].MapOf(k, finest.context.EmptyMap(view));
  });
}

/// The points of the finest level, which each view refines only where it owns the surface.
Result<AssembledCloud> RefineOwned(const LevelState& coarse, const DenseInput& input, const RunContext& run) {
  DRUPE_ASSIGN_OR_RETURN(const FinestLevel finest, PlanFinest(coarse, run));
  ProgressSpan progress(run, kCoarseShare, kAssembledShare, static_cast<double>(finest.cells));
  FinestMaps maps = [&](int view) -> Result<PatchMap> {
    PatchMap map = RefineFinest(finest.context, view, coarse.maps[view], finest.owned[view], run);
    progress.Add(static_cast<double>(CountOwned(finest.owned[view])));
    return map;
  };
  if (input.run_parts && coarse.context.scene->options->parts > 1) {
    DRUPE_ASSIGN_OR_RETURN(maps, RefineInParts(finest, coarse, input, run, progress));
  }
  return AssembleCloud(finest.context, maps, coarse.context, coarse.maps, run);
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
  DRUPE_ASSIGN_OR_RETURN(AssembledCloud assembled, RefineOwned(coarse, input, run));
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
