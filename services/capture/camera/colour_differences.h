#pragma once

#include <cstdint>

#include "capture/camera/colour_lattice.h"
#include "capture/camera/demosaic.h"

namespace drupe {

/// Red less green at the red pixels of a mosaic and blue less green at the blue ones, in 1 / kLevelSteps grey levels.
/// Column i and row j are the pixels of cell (i, j), the 2 x 2 pixels of which the top left one is red; where the
/// mosaic begins with another colour, the first cells begin one pixel outside it.
struct ColourDifferences {
  Lattice red, blue;
};

/// Measures them as Demosaic says (1.), as far as `reach` into the lattices' margin, 5 at most.
ColourDifferences MeasureDifferences(const std::uint8_t* mosaic, int width, int height, RedPlace red, int reach);

}  // namespace drupe
