#pragma once

#include <vector>

#include "reconstruction/dense/expansion.h"

namespace drupe::dense {

/// Corners of a picture (Harris & Stephens 1988), the strongest of every block of pixels that has one at all, as whole
/// pixels in ascending order of row and column. The usual margin for a patch's window is left out.
std::vector<Eigen::Vector2i> FindCorners(const SampledImage& image, int margin);

/// Guesses for parts of the map that have no patch near, from corners matched along epipolar lines (PMVS's own seeding,
/// Furukawa & Ponce 2010, section 3.1): for each corner of the reference the corners of its best neighbours within two
/// pixels of the line, where the two rays meet in the region; the nearest to the line first. What is no surface fails
/// when the guess is refined. `corners` are those of every view at this level.
std::vector<PatchGuess> EpipolarGuesses(const LevelContext& context, int reference,
                                        const std::vector<std::vector<Eigen::Vector2i>>& corners, const PatchMap& map);

}  // namespace drupe::dense
