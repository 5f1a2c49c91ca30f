#pragma once

#include <cstdint>

#include "capture/camera/colour_lattice.h"
#include "capture/camera/demosaic.h"

namespace drupe {

/// What is measured along one direction alone.
struct LineDifferences {
  Lattice own;       ///< at the pixel
  Lattice of_three;  ///< the sum of those at the pixel and the two beside it
  Lattice step;      ///< from the colour's sample before the pixel to the one after it, grey levels
};

/// A colour less green at the pixels behind its filter, in 1 / kLevelSteps grey levels. Column i and row j are the
/// pixel of cell (i, j), the 2 x 2 pixels of which the top left one is red; where the mosaic begins with another
/// colour, the first cells begin one pixel outside it.
struct MeasuredColour {
  Lattice difference;  ///< along all four directions, weighed as Demosaic says (1.)
  LineDifferences across, down;
};

struct ColourDifferences {
  MeasuredColour red, blue;
};

/// Cells of the lattices' margin as far as which differences are measured.
constexpr int kMeasuredReach = 9;

ColourDifferences MeasureDifferences(const std::uint8_t* mosaic, int width, int height, RedPlace red);

}  // namespace drupe
