#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "image/codecs.h"
#include "image/header.h"

namespace drupe {
namespace {

/// What libtiff reads from: bytes in memory and a position. Keeps its first error message.
struct Source {
  std::string_view bytes;
  std::size_t position = 0;
  std::string error;
};

tmsize_t ReadSource(thandle_t handle, void* out, tmsize_t size) {
  auto& source = *static_cast<Source*>(handle);
  const std::size_t count = std::min(static_cast<std::size_t>(size), source.bytes.size() - source.position);
  std::memcpy(out, source.bytes.data() + source.position, count);
  source.position += count;
  return static_cast<tmsize_t>(count);
}

tmsize_t RefuseWrite(thandle_t, void*, tmsize_t) {
  return 0;
}

toff_t SeekSource(thandle_t handle, toff_t offset, int whence) {
  auto& source = *static_cast<Source*>(handle);
  const toff_t base = whence == SEEK_CUR ? source.position : whence == SEEK_END ? source.bytes.size() : 0;
  source.position = static_cast<std::size_t>(std::min<toff_t>(base + offset, source.bytes.size()));
  return source.position;
}

int CloseSource(thandle_t) {
  return 0;
}
toff_t SizeOfSource(thandle_t handle) {
  return static_cast<Source*>(handle)->bytes.size();
}

int KeepError(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  std::string& error = static_cast<Source*>(user)->error;
  if (!error.empty()) return 1;
  std::array<char, 200> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  error = text.data();
  return 1;
}

int IgnoreWarning(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

struct CloseTiff {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using Tiff = std::unique_ptr<TIFF, CloseTiff>;

/// Opens with handlers of this file alone, and with a bound on every buffer that a hostile tile size asks for.
Tiff Open(Source& source, const ImageInfo& info) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                 &TIFFOpenOptionsFree);
  const tmsize_t pixels = static_cast<tmsize_t>(info.width) * info.height;
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), std::max<tmsize_t>(pixels * 8, 16 << 20));
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), KeepError, &source);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), IgnoreWarning, nullptr);
  return Tiff(TIFFClientOpenExt("image", "rm", &source, ReadSource, RefuseWrite, SeekSource, CloseSource, SizeOfSource,
                                nullptr, nullptr, options.get()));
}

/// The codecs that cameras and editors write; the others would only widen what a hostile file can reach.
bool IsAcceptedCompression(TIFF* tiff) {
  std::uint16_t compression = COMPRESSION_NONE;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
  constexpr std::array<int, 6> kAccepted{COMPRESSION_NONE,    COMPRESSION_LZW,      COMPRESSION_ADOBE_DEFLATE,
                                         COMPRESSION_DEFLATE, COMPRESSION_PACKBITS, COMPRESSION_JPEG};
  return std::find(kAccepted.begin(), kAccepted.end(), compression) != kAccepted.end();
}

/// Decodes to 4 x 8 bit a pixel, rows in the order they are stored.
Status ReadRaster(TIFF* tiff, std::vector<std::uint32_t>& raster) {
  std::array<char, 1024> message{};
  TIFFRGBAImage reader;
  if (TIFFRGBAImageBegin(&reader, tiff, /*stop=*/1, message.data()) == 0) {
    return BadImage(std::string("the TIFF cannot be read (") + message.data() + ")");
  }
  reader.req_orientation = reader.orientation;  // the orientation tag would break the calibration, as EXIF's would
  const int ok = TIFFRGBAImageGet(&reader, raster.data(), reader.width, reader.height);
  TIFFRGBAImageEnd(&reader);
  return ok != 0 ? Status::Ok() : BadImage("the TIFF does not decode");
}

Image<std::uint8_t> FromRaster(const std::vector<std::uint32_t>& raster, const ImageInfo& info, int channels) {
  Image<std::uint8_t> image(info.width, info.height, channels);
  for (int y = 0; y < info.height; ++y) {
    const std::uint32_t* in = raster.data() + static_cast<std::size_t>(y) * info.width;
    std::uint8_t* out = image.Row(y);
    for (int x = 0; x < info.width; ++x, ++in, out += channels) {
      const int red = TIFFGetR(*in), green = TIFFGetG(*in), blue = TIFFGetB(*in);
      if (channels == 1) {
        out[0] = LumaFromRgb(red, green, blue);
      } else {
        out[0] = static_cast<std::uint8_t>(red);
        out[1] = static_cast<std::uint8_t>(green);
        out[2] = static_cast<std::uint8_t>(blue);
      }
    }
  }
  return image;
}

}  // namespace

Result<Image<std::uint8_t>> DecodeTiff(std::string_view bytes, const ImageInfo& info, int channels) {
  Source source{.bytes = bytes, .position = 0, .error = {}};
  const Tiff tiff = Open(source, info);
  if (!tiff) return BadImage("the TIFF cannot be opened (" + source.error + ")");
  if (!IsAcceptedCompression(tiff.get())) {
    return Status(StatusKind::kUnsupportedMedia, "unsupported_image",
                  "the TIFF's compression is not accepted; none, LZW, Deflate, PackBits and JPEG are");
  }
  std::uint32_t width = 0, height = 0;
  TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &width);
  TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &height);
  if (width != static_cast<std::uint32_t>(info.width) || height != static_cast<std::uint32_t>(info.height)) {
    return BadImage("the TIFF contradicts its own size");
  }
  std::vector<std::uint32_t> raster(static_cast<std::size_t>(width) * height);
  const Status read = ReadRaster(tiff.get(), raster);
  if (!read.ok()) return read;
  if (!source.error.empty()) return BadImage("the TIFF does not decode (" + source.error + ")");
  return FromRaster(raster, info, channels);
}

}  // namespace drupe
