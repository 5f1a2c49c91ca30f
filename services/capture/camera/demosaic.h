#pragma once

#include <cstdint>

#include "image/image.h"

namespace drupe {

/// Where red lies in the top left 2 x 2 pixels of a Bayer mosaic; blue lies diagonally across.
struct RedPlace {
  int x = 0, y = 0;  ///< 0 or 1
};

/// Interpolates the colours of a mosaic of width x height bytes, 4 x 4 at least: green along the direction in which the
/// differences of colours change less, then red and blue through those differences, which are smoothed along the same
/// direction (Menon, Andriani & Calvagno, "Demosaicing with directional filtering and a posteriori decision", IEEE
/// Trans. Image Processing 2007). At the border pixels are mirrored.
RgbImage Demosaic(const std::uint8_t* mosaic, int width, int height, RedPlace red);

}  // namespace drupe
