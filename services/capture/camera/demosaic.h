#pragma once

#include <cstdint>

#include "image/image.h"

namespace drupe {

/// Where red lies in the top left 2 x 2 pixels of a Bayer mosaic; blue lies diagonally across.
struct RedPlace {
  int x = 0, y = 0;  ///< 0 or 1
};

/// Interpolates the colours of a mosaic of width x height bytes, 4 x 4 at least. Every pixel keeps what was measured
/// there; all else follows from the differences of red and of blue to green, which change slowly:
/// 1. At red and blue pixels they are measured against green interpolated across and down (Hamilton & Adams, US patent
///    5,629,734), and kept along the direction in which they change less within 5 x 5 pixels (Menon, Andriani &
///    Calvagno, "Demosaicing with directional filtering and a posteriori decision", IEEE Trans. Image Processing 2007).
/// 2. Three medians over 3 x 3 measured differences of a colour drop those that an edge or noise has spoilt (Freeman,
/// US
///    patent 4,724,395), and a light smoothing takes away the steps that medians leave.
/// 3. Between measured pixels they are interpolated bilinearly.
/// So luma is as sharp as the mosaic, and its noise is that of one sample a pixel; colour is resolved to about four
/// pixels. At the border pixels are mirrored.
RgbImage Demosaic(const std::uint8_t* mosaic, int width, int height, RedPlace red);

}  // namespace drupe
