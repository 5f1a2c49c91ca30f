#include "image/exif.h"

#include <algorithm>
#include <cmath>

#include "image/tiff_directory.h"

namespace drupe {
namespace {

constexpr std::uint16_t kExifDirectory = 0x8769;
constexpr std::uint16_t kFocalLength = 0x920A;            // mm
constexpr std::uint16_t kPixelXDimension = 0xA002;        // width when the picture was taken
constexpr std::uint16_t kFocalPlaneXResolution = 0xA20E;  // pixels per unit
constexpr std::uint16_t kFocalPlaneResolutionUnit = 0xA210;
constexpr std::uint16_t kFocalLengthIn35mmFilm = 0xA405;

double UnitMm(double unit) {
  return unit == 3 ? 10.0 : unit == 4 ? 1.0 : 25.4;
}

/// 0 when the tags are not there.
double FromFocalPlane(const TiffDirectory& exif, int width) {
  const double focal_mm = exif.Number(kFocalLength).value_or(0);
  const double resolution = exif.Number(kFocalPlaneXResolution).value_or(0);
  const double unit_mm = UnitMm(exif.Number(kFocalPlaneResolutionUnit).value_or(2));
  // A picture that was resized later keeps the resolution of the original.
  const double original_width = exif.Number(kPixelXDimension).value_or(width);
  return original_width > 0 ? focal_mm * resolution / unit_mm * width / original_width : 0;
}

/// 0 when the tag is not there. The equivalence is one of diagonals (CIPA DCG-001).
double From35mmFilm(const TiffDirectory& exif, int width, int height) {
  const double film_diagonal_mm = std::hypot(36.0, 24.0);
  return exif.Number(kFocalLengthIn35mmFilm).value_or(0) * std::hypot(width, height) / film_diagonal_mm;
}

bool IsPlausible(double focal_px, int width, int height) {
  const double side = std::max(width, height);
  return focal_px > 0.2 * side && focal_px < 100.0 * side;
}

}  // namespace

double ExifFocalPx(std::string_view exif, int width, int height) {
  const auto first = TiffDirectory::First(exif);
  const auto directory = first ? first->Directory(kExifDirectory) : std::nullopt;
  if (!directory) return 0;
  for (const double focal_px : {FromFocalPlane(*directory, width), From35mmFilm(*directory, width, height)}) {
    if (IsPlausible(focal_px, width, height)) return focal_px;
  }
  return 0;
}

}  // namespace drupe
