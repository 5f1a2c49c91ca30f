#pragma once

#include <span>
#include <vector>

#include "reconstruction/features/extrema.h"

namespace drupe {

/// At most `max_count` of the extrema: each cell of a grid over the picture gives its strongest, as many as every other
/// cell that has them. Duplicates (two samples that were refined to one extremum) are removed. The result is ordered by
/// scale, coarsest first, then by row and column.
std::vector<Extremum> SelectSpread(std::vector<Extremum> extrema, std::span<const Octave> octaves, int cell_px,
                                   int max_count);

}  // namespace drupe
