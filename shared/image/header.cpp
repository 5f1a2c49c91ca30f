#include "image/header.h"

#include <cstdint>
#include <string>

#include "image/exif.h"
#include "image/tiff_directory.h"

namespace drupe {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;

std::uint32_t Byte(std::string_view bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}
std::uint32_t Big16(std::string_view bytes, std::size_t at) {
  return Byte(bytes, at) << 8 | Byte(bytes, at + 1);
}
std::uint32_t Big32(std::string_view bytes, std::size_t at) {
  return Big16(bytes, at) << 16 | Big16(bytes, at + 2);
}

Status Unsupported(std::string what) {
  return {StatusKind::kUnsupportedMedia, "unsupported_image", what + "; JPEG, PNG and TIFF are accepted"};
}

/// Sizes of 2^31 and more become -1, which no limit accepts.
int SideFrom(double value) {
  return value >= 0 && value <= 2147483647.0 ? static_cast<int>(value) : -1;
}

bool IsStartOfFrame(std::uint32_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

bool HasLength(std::uint32_t marker) {
  return marker != 0x01 && !(marker >= 0xD0 && marker <= 0xD7);
}

/// `segment` is the content of a start-of-frame segment: precision, height, width, components (ITU T.81, B.2.2).
Status ReadFrame(std::uint32_t marker, std::string_view segment, ImageInfo& info) {
  if (segment.size() < 6) return BadImage("the JPEG frame header is cut off");
  const bool huffman_or_arithmetic_dct = marker <= 0xC2 || marker == 0xC9 || marker == 0xCA;
  if (!huffman_or_arithmetic_dct || Byte(segment, 0) != 8)
    return Unsupported("a lossless, differential or 12-bit JPEG");
  const std::uint32_t components = Byte(segment, 5);
  if (components != 1 && components != 3) return Unsupported("a JPEG that is neither gray nor YCbCr");
  info.height = SideFrom(Big16(segment, 1));
  info.width = SideFrom(Big16(segment, 3));
  return Status::Ok();
}

Result<ImageInfo> ReadJpeg(std::string_view bytes) {
  ImageInfo info{.format = ImageFormat::kJpeg};
  std::string_view exif;
  std::size_t at = 2;
  while (at + 4 <= bytes.size()) {
    if (Byte(bytes, at) != 0xFF) return BadImage("a JPEG segment does not start with a marker");
    const std::uint32_t marker = Byte(bytes, at + 1);
    if (marker == 0xFF || !HasLength(marker)) {
      at += marker == 0xFF ? 1 : 2;
      continue;
    }
    const std::size_t length = Big16(bytes, at + 2);
    if (length < 2 || length > bytes.size() - at - 2) return BadImage("a JPEG segment is cut off");
    const std::string_view segment = bytes.substr(at + 4, length - 2);
    if (marker == 0xE1 && segment.starts_with("Exif\0\0"sv)) exif = segment.substr(6);
    if (marker == 0xDA || marker == 0xD9) break;  // the picture's data, or its end, before any frame header
    if (IsStartOfFrame(marker)) {
      DRUPE_RETURN_IF_ERROR(ReadFrame(marker, segment, info));
      info.exif_focal_px = ExifFocalPx(exif, info.width, info.height);
      return info;
    }
    at += 2 + length;
  }
  return BadImage("the JPEG has no frame header");
}

/// Walks all chunks, because the decoder stops at the last row and would not miss a cut off end.
Result<ImageInfo> ReadPng(std::string_view bytes) {
  ImageInfo info{.format = ImageFormat::kPng};
  std::string_view exif;
  for (std::size_t at = kPngSignature.size(); at + 12 <= bytes.size();) {
    const std::size_t length = Big32(bytes, at);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - 12) return BadImage("a PNG chunk is cut off");
    if (at == kPngSignature.size()) {
      if (type != "IHDR" || length != 13) return BadImage("the PNG does not start with its header chunk");
      info.width = SideFrom(Big32(bytes, at + 8));
      info.height = SideFrom(Big32(bytes, at + 12));
    }
    if (type == "eXIf") exif = bytes.substr(at + 8, length);
    if (type == "IEND") {
      info.exif_focal_px = ExifFocalPx(exif, info.width, info.height);
      return info;
    }
    at += 12 + length;
  }
  return BadImage("the PNG has no end chunk");
}

Result<ImageInfo> ReadTiff(std::string_view bytes) {
  constexpr std::uint16_t kImageWidth = 256, kImageLength = 257;
  const auto directory = TiffDirectory::First(bytes);
  if (!directory) return BadImage("the TIFF directory is missing or cut off");
  ImageInfo info{.format = ImageFormat::kTiff};
  info.width = SideFrom(directory->Number(kImageWidth).value_or(0));
  info.height = SideFrom(directory->Number(kImageLength).value_or(0));
  info.exif_focal_px = ExifFocalPx(bytes, info.width, info.height);
  return info;
}

}  // namespace

Status BadImage(std::string_view what) {
  return Unprocessable("bad_image", std::string(what) + ": the file is truncated or corrupt");
}

Result<ImageInfo> ReadImageHeader(std::string_view bytes) {
  if (bytes.empty()) return BadImage("the file is empty");
  if (bytes.starts_with("\xFF\xD8\xFF"sv)) return ReadJpeg(bytes);
  if (bytes.starts_with(kPngSignature)) return ReadPng(bytes);
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return ReadTiff(bytes);
  return Unsupported("the file is not an accepted picture");
}

}  // namespace drupe
