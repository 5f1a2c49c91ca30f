#include "image/decode.h"

#include <exception>
#include <string>

#include "image/codecs.h"
#include "image/header.h"

namespace drupe {
namespace {

Status TooLarge(std::string message) {
  return {StatusKind::kTooLarge, "image_too_large", std::move(message)};
}

Status CheckSize(const ImageInfo& info, const Limits& limits) {
  const std::string size = std::to_string(info.width) + "x" + std::to_string(info.height);
  if (info.width == 0 || info.height == 0) return BadImage("the header says " + size + " pixels");
  const int side = limits.max_image_side_px;
  if (info.width < 0 || info.height < 0 || info.width > side || info.height > side) {
    return TooLarge("the picture is " + size + " pixels; the limit is " + std::to_string(side) + " a side");
  }
  if (std::int64_t{info.width} * info.height > limits.max_image_pixels) {
    return TooLarge("the picture is " + size + " pixels; the limit is " + std::to_string(limits.max_image_pixels) +
                    " pixels in all");
  }
  return Status::Ok();
}

Result<Image<std::uint8_t>> DecodeFormat(std::string_view bytes, const ImageInfo& info, int channels) {
  switch (info.format) {
    case ImageFormat::kJpeg:
      return DecodeJpeg(bytes, info, channels);
    case ImageFormat::kPng:
      return DecodePng(bytes, info, channels);
    case ImageFormat::kTiff:
      return DecodeTiff(bytes, info, channels);
  }
  return Internal("unknown_format", "the image format has no decoder");
}

Result<Image<std::uint8_t>> Decode(std::string_view bytes, const Limits& limits, int channels) {
  DRUPE_ASSIGN_OR_RETURN(const ImageInfo info, ProbeImage(bytes, limits));
  try {
    return DecodeFormat(bytes, info, channels);
  } catch (const std::exception&) {  // only memory can run out here
    return Status(StatusKind::kUnavailable, "out_of_memory", "not enough memory to decode the picture now");
  }
}

}  // namespace

Result<ImageInfo> ProbeImage(std::string_view bytes, const Limits& limits) {
  if (bytes.size() > limits.max_image_bytes) {
    return TooLarge("the file has " + std::to_string(bytes.size()) + " bytes; the limit is " +
                    std::to_string(limits.max_image_bytes));
  }
  DRUPE_ASSIGN_OR_RETURN(const ImageInfo info, ReadImageHeader(bytes));
  DRUPE_RETURN_IF_ERROR(CheckSize(info, limits));
  return info;
}

Result<GrayImage> DecodeGray(std::string_view bytes, const Limits& limits) {
  return Decode(bytes, limits, 1);
}

Result<RgbImage> DecodeRgb(std::string_view bytes, const Limits& limits) {
  return Decode(bytes, limits, 3);
}

Result<ImageInfo> VerifyImage(std::string_view bytes, const Limits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const GrayImage image, DecodeGray(bytes, limits));
  return ProbeImage(bytes, limits);
}

}  // namespace drupe
