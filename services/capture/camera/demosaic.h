#pragma once

#include <cstdint>

#include "image/image.h"

namespace drupe {

/// Where red lies in the top left 2 x 2 pixels of a Bayer mosaic; blue lies diagonally across.
struct RedPlace {
  int x = 0, y = 0;  ///< 0 or 1
};

/// Interpolates the colours of a mosaic of width x height bytes, 4 x 4 at least, through the differences of red and of
/// blue to green, which change slowly:
/// 1. At red and blue pixels they are measured against green interpolated across and down (Hamilton & Adams, US patent
///    5,629,734), and kept along the direction in which they change less within 5 x 5 pixels (Menon, Andriani &
///    Calvagno, "Demosaicing with directional filtering and a posteriori decision", IEEE Trans. Image Processing 2007).
/// 2. A median over 3 x 3 measured differences of a colour drops those that an edge or noise has spoilt (Freeman, US
///    patent 4,724,395); between measured pixels they are interpolated bilinearly. They give the colour.
/// 3. Two medians more and a light smoothing make them even enough for luma: the sample and the differences give it to
///    less than a grey level where colours do not change within a few pixels, and its noise is that of one sample a
///    pixel.
/// At the border pixels are mirrored.
RgbImage Demosaic(const std::uint8_t* mosaic, int width, int height, RedPlace red);

}  // namespace drupe
