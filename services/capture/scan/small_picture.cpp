#include "capture/scan/small_picture.h"

#include <turbojpeg.h>

#include <algorithm>
#include <memory>

#include "image/codecs.h"

namespace drupe {
namespace {

struct CloseCompressor {
  void operator()(void* handle) const { tjDestroy(handle); }
};

struct FreeJpeg {
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};

}  // namespace

GrayImage GrayOf(const RgbImage& image) {
  GrayImage gray(image.width(), image.height(), 1);
  for (int y = 0; y < image.height(); ++y) {
    const std::uint8_t* rgb = image.Row(y);
    std::uint8_t* out = gray.Row(y);
    for (int x = 0; x < image.width(); ++x, rgb += 3) out[x] = LumaFromRgb(rgb[0], rgb[1], rgb[2]);
  }
  return gray;
}

GrayImage Halve(const GrayImage& image) {
  return ShrinkTo(image, (image.width() + 1) / 2);
}

Image<std::uint8_t> ShrinkTo(const Image<std::uint8_t>& image, int width) {
  const int factor = std::max(1, (image.width() + width - 1) / width), channels = image.channels();
  Image<std::uint8_t> small(std::max(1, image.width() / factor), std::max(1, image.height() / factor), channels);
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width() * channels; ++x) {
      const int left = x / channels * factor, channel = x % channels;
      int sum = 0;
      for (int j = 0; j < factor; ++j) {
        for (int i = 0; i < factor; ++i) sum += image.At(left + i, y * factor + j, channel);
      }
      small.Row(y)[x] = static_cast<std::uint8_t>((sum + factor * factor / 2) / (factor * factor));
    }
  }
  return small;
}

Result<std::string> EncodeJpeg(const RgbImage& image, int quality) {
  const std::unique_ptr<void, CloseCompressor> compressor(tjInitCompress());
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(compressor.get(), image.Row(0), image.width(), static_cast<int>(image.stride()),
                                 image.height(), TJPF_RGB, &bytes, &size, TJSAMP_444, quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, FreeJpeg> owner(bytes);
  if (failed != 0) return Internal("jpeg_failed", tjGetErrorStr2(compressor.get()));
  return std::string(reinterpret_cast<const char*>(bytes), size);
}

}  // namespace drupe
