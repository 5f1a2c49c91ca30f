#include "image/encode.h"

#include <png.h>

namespace drupe {

Result<std::string> EncodePng(const RgbImage& image) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::string bytes(size, '\0');
  const int written = png_image_write_to_memory(&header, bytes.data(), &size, 0, image.Row(0),
                                                static_cast<png_int_32>(image.stride()), nullptr);
  if (written == 0) return Internal("png_not_written", header.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace drupe
