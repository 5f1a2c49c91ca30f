#pragma once

#include <functional>
#include <vector>

#include "reconstruction/dense/level_context.h"

namespace drupe::dense {

/// Guesses from the sparse tracks that `reference` is likely to see, several normals for each.
std::vector<PatchGuess> SeedGuesses(const LevelContext& context, int reference, const PatchMap& map);

/// Refines the guesses in order and keeps in each cell the acceptable patch with the best NCC. A guess is
/// trusted as far as the sigma of its plane and `slope_sigma` (both pixels of parallax, the latter a pixel) say. Stops
/// early when `cancelled`.
void PlaceGuesses(const LevelContext& context, int reference, const std::vector<PatchGuess>& guesses, float slope_sigma,
                  const std::function<bool()>& cancelled, PatchMap* map);

/// Puts every guess into its cell where that is empty: the surface is known from coarser levels or other views, though
/// this level's pixels (too little texture, a highlight) do not confirm it.
void KeepGuesses(const std::vector<PatchGuess>& guesses, PatchMap* map);

/// Grows the map from its filled cells into empty ones, best NCC first, each new patch starting from its neighbour's
/// plane. Stops early when `cancelled`.
void Expand(const LevelContext& context, int reference, const std::function<bool()>& cancelled, PatchMap* map);

}  // namespace drupe::dense
