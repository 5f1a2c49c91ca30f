#pragma once

#include <string_view>

#include "base/status.h"
#include "image/decode.h"
#include "image/image.h"

namespace drupe {

/// Decoders of one format each. `info` comes from ProbeImage on the same bytes, so its size is within the limits; a
/// file whose pixels turn out otherwise, and every warning of the underlying library that means lost pixels, gives 422
/// `bad_image`. `channels` is 1 (luma, ITU-R BT.601) or 3 (RGB).
Result<Image<std::uint8_t>> DecodeJpeg(std::string_view bytes, const ImageInfo& info, int channels);
Result<Image<std::uint8_t>> DecodePng(std::string_view bytes, const ImageInfo& info, int channels);
Result<Image<std::uint8_t>> DecodeTiff(std::string_view bytes, const ImageInfo& info, int channels);

/// Luma of an RGB pixel, rounded; the weights that JPEG uses, so that a picture gives the same features in any format.
inline std::uint8_t LumaFromRgb(int red, int green, int blue) {
  return static_cast<std::uint8_t>((19595 * red + 38470 * green + 7471 * blue + 32768) >> 16);
}

}  // namespace drupe
