#pragma once

#include <string_view>

#include "base/limits.h"
#include "base/status.h"
#include "image/image.h"

namespace drupe {

enum class ImageFormat { kJpeg, kPng, kTiff };

/// What an image file's header says; nothing is decoded to learn it.
struct ImageInfo {
  ImageFormat format = ImageFormat::kJpeg;
  int width = 0;   ///< pixels, as stored: EXIF rotation is ignored, since it would break the calibration
  int height = 0;  ///< pixels
  /// Focal length in pixels from EXIF (FocalLengthIn35mmFilm, or FocalLength with the focal-plane resolution); 0: unknown.
  double exif_focal_px = 0;
};

/// Reads format (by magic bytes) and size from the header and checks both against the limits. Errors: 415
/// `unsupported_image` (not JPEG, PNG or TIFF), 422 `bad_image` (broken header), 413 `image_too_large` (bytes, side or
/// pixels, with the limit).
Result<ImageInfo> ProbeImage(std::string_view bytes, const Limits& limits = {});

/// Decodes a whole image after ProbeImage accepted it. A truncated file, or one whose pixels do not fill the size that
/// its header promised, gives 422 `bad_image`. 16-bit pictures are reduced to 8.
Result<GrayImage> DecodeGray(std::string_view bytes, const Limits& limits = {});
Result<RgbImage> DecodeRgb(std::string_view bytes, const Limits& limits = {});

/// Checks that the whole file decodes, as intake does, without keeping the picture.
Result<ImageInfo> VerifyImage(std::string_view bytes, const Limits& limits = {});

}  // namespace drupe
