#pragma once

#include <string>

#include "base/status.h"
#include "image/image.h"

namespace drupe {

/// Luma of a colour picture (ITU-R BT.601).
GrayImage GrayOf(const RgbImage& image);
/// Half the size, each pixel the mean of four.
GrayImage Halve(const GrayImage& image);
/// At most `width` wide, each pixel the mean of a whole number of pixels either way; 1 or 3 channels.
Image<std::uint8_t> ShrinkTo(const Image<std::uint8_t>& image, int width);

/// JPEG with full colour resolution at `quality` 1..100. Errors: 500 `jpeg_failed`.
Result<std::string> EncodeJpeg(const RgbImage& image, int quality);

}  // namespace drupe
