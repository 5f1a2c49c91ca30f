#include "reconstruction/dense/exchange.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/parallel.h"
#include "reconstruction/dense/expansion.h"
#include "reconstruction/dense/visibility.h"

namespace drupe::dense {

namespace {

constexpr float kDepthSigma = 0.3f, kSlopeSigma = 0.05f;  ///< pixels of parallax; the latter a pixel
constexpr float kMostMoved = 0.8f;  ///< pixels of parallax: further off, a highlight draws the patch, not the skin

/// The patches of the neighbours that agree with `reference` and lie in empty cells of its map: of each cell the one
/// with the best NCC.
std::vector<PatchGuess> OfferedPatches(const LevelContext& context, int reference, const std::vector<PatchMap>& maps) {
  PatchMap offered = context.EmptyMap(reference);
  for (const int neighbour : context.scene->neighbours[reference]) {
    const std::vector<int>& theirs = context.scene->neighbours[neighbour];
    const auto found = std::find(theirs.begin(), theirs.end(), reference);
    if (found == theirs.end()) continue;
    const std::uint32_t bit = std::uint32_t{1} << (found - theirs.begin());
    for (std::size_t i = 0; i < maps[neighbour].cells.size(); ++i) {
      if ((maps[neighbour].cells[i].views & bit) == 0) continue;
      const std::optional<PatchGuess> seen = SeenFrom(context, reference, neighbour, maps, static_cast<int>(i));
      if (seen && seen->plane.ncc > offered.cells[seen->cell].ncc) offered.cells[seen->cell] = seen->plane;
    }
  }
  std::vector<PatchGuess> guesses;
  for (std::size_t i = 0; i < offered.cells.size(); ++i) {
    if (!offered.cells[i].Filled()) continue;
    guesses.push_back({static_cast<int>(i), offered.cells[i]});
    guesses.back().plane.sigma = kDepthSigma;
  }
  return guesses;
}

/// Empties the cells whose patch has left its guess.
void DropMoved(const std::vector<PatchGuess>& guesses, PatchMap* map) {
  for (const PatchGuess& guess : guesses) {
    PatchCell& cell = map->cells[guess.cell];
    if (std::abs(cell.w - guess.plane.w) > kMostMoved * map->unit) cell = PatchCell();
  }
}

}  // namespace

Status ExchangePatches(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps) {
  std::vector<std::vector<PatchGuess>> offers(maps->size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, maps->size(), [&](std::size_t view) {
    offers[view] = OfferedPatches(context, static_cast<int>(view), *maps);
  }));
  return ParallelFor(run, maps->size(), [&](std::size_t view) {
    PatchMap* map = &(*maps)[view];
    PlaceGuesses(context, static_cast<int>(view), offers[view], kSlopeSigma, run.cancelled, map);
    DropMoved(offers[view], map);
  });
}

}  // namespace drupe::dense
