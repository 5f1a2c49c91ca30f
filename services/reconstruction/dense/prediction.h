#pragma once

#include <cstdint>
#include <vector>

#include "reconstruction/dense/expansion.h"

namespace drupe::dense {

/// Guesses for the cells of `fine` from the patches of the same view one or more levels above: the planes of the four
/// nearest coarse cells, blended bilinearly where they belong to one surface. `wanted` (a flag a coarse cell, or empty
/// for all) limits where. At most one guess a cell, in ascending order.
std::vector<PatchGuess> PredictGuesses(const PatchMap& coarse, const std::vector<std::uint8_t>& wanted,
                                       const PatchMap& fine);

}  // namespace drupe::dense
