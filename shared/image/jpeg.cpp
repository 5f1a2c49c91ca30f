#include <turbojpeg.h>

#include <memory>
#include <string>

#include "image/codecs.h"
#include "image/header.h"

namespace drupe {
namespace {

struct DestroyHandle {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Decompressor = std::unique_ptr<void, DestroyHandle>;

Status Failure(const Decompressor& decompressor) {
  return BadImage(std::string("the JPEG does not decode (") + tjGetErrorStr2(decompressor.get()) + ")");
}

}  // namespace

Result<Image<std::uint8_t>> DecodeJpeg(std::string_view bytes, const ImageInfo& info, int channels) {
  const Decompressor decompressor(tjInitDecompress());
  if (!decompressor) return Internal("jpeg_init_failed", "libturbojpeg cannot be initialised");
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, colour_space = 0;
  if (tjDecompressHeader3(decompressor.get(), data, bytes.size(), &width, &height, &subsampling, &colour_space) != 0) {
    return Failure(decompressor);
  }
  if (width != info.width || height != info.height) return BadImage("the JPEG contradicts its own size");
  Image<std::uint8_t> image(width, height, channels);
  // Warnings (premature end, corrupt entropy data) also make the call fail: pixels behind them are invented. The limit
  // on scans stops progressive files that cost minutes.
  const int format = channels == 1 ? TJPF_GRAY : TJPF_RGB;
  const int pitch = static_cast<int>(image.stride());
  if (tjDecompress2(decompressor.get(), data, bytes.size(), image.Row(0), width, pitch, height, format,
                    TJFLAG_LIMITSCANS) != 0) {
    return Failure(decompressor);
  }
  return image;
}

}  // namespace drupe
