#include <png.h>

#include <string>

#include "image/codecs.h"
#include "image/header.h"

namespace drupe {
namespace {

/// Owns libpng's simplified reader, which needs no setjmp in our code.
struct PngReader {
  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  Status Failure() const { return BadImage(std::string("the PNG does not decode (") + image.message + ")"); }

  png_image image{};
};

Image<std::uint8_t> LumaOf(const Image<std::uint8_t>& rgb) {
  Image<std::uint8_t> gray(rgb.width(), rgb.height());
  for (int y = 0; y < rgb.height(); ++y) {
    const std::uint8_t* in = rgb.Row(y);
    for (int x = 0; x < rgb.width(); ++x, in += 3) gray.Row(y)[x] = LumaFromRgb(in[0], in[1], in[2]);
  }
  return gray;
}

}  // namespace

Result<Image<std::uint8_t>> DecodePng(std::string_view bytes, const ImageInfo& info, int channels) {
  PngReader reader;
  if (png_image_begin_read_from_memory(&reader.image, bytes.data(), bytes.size()) == 0) return reader.Failure();
  if (reader.image.width != static_cast<png_uint_32>(info.width) ||
      reader.image.height != static_cast<png_uint_32>(info.height)) {
    return BadImage("the PNG contradicts its own size");
  }
  const bool has_colour = (reader.image.format & PNG_FORMAT_FLAG_COLOR) != 0;
  const int decoded_channels = has_colour ? 3 : channels;
  reader.image.format = decoded_channels == 3 ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY;
  // Without this a 16-bit file is taken for linear light and comes out brighter than the same file in 8 bits.
  reader.image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  Image<std::uint8_t> image(info.width, info.height, decoded_channels);
  const png_color black{0, 0, 0};
  if (png_image_finish_read(&reader.image, &black, image.Row(0), static_cast<png_int_32>(image.stride()), nullptr) ==
      0) {
    return reader.Failure();
  }
  if (decoded_channels == channels) return image;
  return LumaOf(image);
}

}  // namespace drupe
