#include "capture/simulator/picture_turn.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/files.h"
#include "image/codecs.h"
#include "image/decode.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

/// Channel (0 red, 1 green, 2 blue) of a pixel behind the filter whose top left 2 x 2 cell reads `cell`.
int FilterChannel(const char* cell, int x, int y) {
  const char colour = cell[(y & 1) * 2 + (x & 1)];
  return colour == 'R' ? 0 : colour == 'G' ? 1 : 2;
}

const char* FilterOf(std::uint32_t pixel_format) {
  switch (pixel_format) {
    case kPfncBayerGr8:
      return "GRBG";
    case kPfncBayerRg8:
      return "RGGB";
    case kPfncBayerGb8:
      return "GBRG";
    default:
      return "BGGR";
  }
}

RgbImage Smear(const RgbImage& sharp, int radius) {
  RgbImage smeared(sharp.width(), sharp.height(), 3);
  for (int y = 0; y < sharp.height(); ++y) {
    for (int x = 0; x < sharp.width(); ++x) {
      const int from = std::max(0, x - radius), to = std::min(sharp.width() - 1, x + radius);
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int i = from; i <= to; ++i) sum += sharp.At(i, y, c);
        smeared.At(x, y, c) = static_cast<std::uint8_t>(sum / (to - from + 1));
      }
    }
  }
  return smeared;
}

/// One row of the window.
void ExposeRow(const RgbImage& picture, const SensorWindow& window, int row, std::uint8_t* out) {
  const int y = window.y + row;
  const std::uint8_t* rgb = picture.Row(y) + 3 * window.x;
  if (window.pixel_format == kPfncRgb8) {
    std::memcpy(out, rgb, static_cast<std::size_t>(window.width) * 3);
    return;
  }
  const char* filter = FilterOf(window.pixel_format);
  for (int x = 0; x < window.width; ++x, rgb += 3) {
    const bool mono = window.pixel_format == kPfncMono8;
    out[x] = mono ? LumaFromRgb(rgb[0], rgb[1], rgb[2]) : rgb[FilterChannel(filter, x, row)];
  }
}

}  // namespace

int BytesPerPixel(std::uint32_t pixel_format) {
  switch (pixel_format) {
    case kPfncRgb8:
      return 3;
    case kPfncMono8:
    case kPfncBayerGr8:
    case kPfncBayerRg8:
    case kPfncBayerGb8:
    case kPfncBayerBg8:
      return 1;
    default:
      return 0;
  }
}

Result<PictureTurn> PictureTurn::Load(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    if (entry.path().extension() != ".json") files.push_back(entry.path());  // what pictures are described by
  }
  if (error) return StatusFromErrno(error.value(), "read", directory);
  std::sort(files.begin(), files.end());
  std::vector<RgbImage> pictures;
  for (const fs::path& file : files) {
    DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(file));
    DRUPE_ASSIGN_OR_RETURN(RgbImage picture, DecodeRgb(bytes));
    pictures.push_back(std::move(picture));
    if (pictures.back().width() != pictures[0].width() || pictures.back().height() != pictures[0].height()) {
      return Unprocessable("bad_pictures", file.string() + " has another size than the pictures before it");
    }
  }
  if (pictures.empty()) return Unprocessable("bad_pictures", directory.string() + " holds no pictures");
  return PictureTurn(std::move(pictures));
}

void PictureTurn::Expose(double angle_deg, int blur_px, const SensorWindow& window,
                         std::span<std::uint8_t> pixels) const {
  const long nearest = std::lround(angle_deg / step_deg()) % count();
  const RgbImage& sharp = pictures_[static_cast<std::size_t>((nearest + count()) % count())];
  const RgbImage smeared = blur_px > 0 ? Smear(sharp, blur_px) : RgbImage();
  const RgbImage& picture = blur_px > 0 ? smeared : sharp;
  const std::size_t row_bytes = static_cast<std::size_t>(window.width) * BytesPerPixel(window.pixel_format);
  for (int row = 0; row < window.height; ++row) ExposeRow(picture, window, row, pixels.data() + row * row_bytes);
}

}  // namespace drupe
