#pragma once

#include <string_view>

namespace drupe {

/// Focal length in pixels of a picture of width x height, from its EXIF block (TIFF structure, without "Exif\0\0"):
/// from FocalLength and the focal plane's resolution, else from FocalLengthIn35mmFilm. 0 when it is not there or
/// outside the range of real lenses. EXIF 2.32, tables 7 and 8.
double ExifFocalPx(std::string_view exif, int width, int height);

}  // namespace drupe
