#pragma once

#include <array>
#include <vector>

namespace drupe {

/// rows[s][r]: row r (above, middle, below) of the difference of Gaussians one level finer, the same, one level
/// coarser.
using DogNeighbourhood = std::array<std::array<const float*, 3>, 3>;

/// out[x] = coarse[x] - fine[x] for x in [0, width), rounded up to whole vectors (the rows must have room).
void SubtractRows(const float* coarse, const float* fine, int width, float* out);

/// Appends every x in [begin, end) whose middle value exceeds all its 26 neighbours, or is below all of them, and is
/// larger than `threshold` in magnitude. begin >= 1, and one value beyond `end` is read.
void FindExtremaInRow(const DogNeighbourhood& rows, int begin, int end, float threshold, std::vector<int>& out);

}  // namespace drupe
