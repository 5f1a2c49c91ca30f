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
/// 1. Along rows and columns they are measured at every pixel, against the other colour interpolated (Hamilton & Adams,
///    US patent 5,629,734). At red and blue pixels those of the four pixels on each side are averaged, and the sides
///    weighed by how little differences change there within 5 x 5 pixels, to the power of -4 (Pekkucuksen &
///    Altunbasak, "Gradient based threshold free color filter array interpolation", ICIP 2010, which has -2 and five).
/// 2. A median over 3 x 3 measured differences of a colour drops those that an edge or noise has spoilt (Freeman, US
///    patent 4,724,395); between measured pixels they are interpolated bilinearly. They give the colour.
/// 3. Two medians more and a light smoothing make them even enough for luma: the sample and the differences give it to
///    less than a grey level where colours do not change within a few pixels, and its noise is that of one sample a
///    pixel.
/// 4. What 2. and 3. took away was noise, or an edge that spoilt one direction, unless rows and columns tell the same:
///    let u and v be what three pixels of the row and of the column tell less 3. smoothed once more, p and q how much
///    the three bend, and s and t how much the samples change about the pixel: edges sharper than the mosaic, such as
///    those of black markers on white paper, spoil both directions alike, in proportion to their height. Let r be the
///    sum of 2 u v over that of u^2 + v^2 + (p^2 + q^2) / 2 + s^2 + t^2 within 7 x 7 measured pixels, u, v, p and q in
///    1 / 6 grey levels and s and t in whole ones. Where r is more than a half, 8 (2 r - 1) / (7 (2 r - 1) + 1) of what
///    was taken away is given back, so that clean frames with sharp colours stay sharp.
/// At the border pixels are mirrored.
RgbImage Demosaic(const std::uint8_t* mosaic, int width, int height, RedPlace red);

}  // namespace drupe
