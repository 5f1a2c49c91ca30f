#include <algorithm>
#include <cstring>

#include "capture/camera/raw_frame.h"

namespace drupe {
namespace {

constexpr int kMargin = 2;  // of the filters

/// A mosaic with mirrored borders. Mirroring about a pixel keeps the pattern of colours.
class PaddedMosaic {
 public:
  explicit PaddedMosaic(const RawFrame& frame) : stride_(frame.width + 2 * kMargin) {
    pixels_.resize(static_cast<std::size_t>(stride_) * (frame.height + 2 * kMargin));
    for (int y = -kMargin; y < frame.height + kMargin; ++y) {
      const std::uint8_t* from = frame.bytes.data() + std::size_t(Mirror(y, frame.height)) * frame.width;
      std::uint8_t* to = pixels_.data() + std::size_t(y + kMargin) * stride_ + kMargin;
      std::memcpy(to, from, static_cast<std::size_t>(frame.width));
      for (int i = 1; i <= kMargin; ++i) to[-i] = from[i], to[frame.width - 1 + i] = from[frame.width - 1 - i];
    }
  }

  int stride() const { return stride_; }
  const std::uint8_t* At(int y) const { return pixels_.data() + std::size_t(y + kMargin) * stride_ + kMargin; }

 private:
  static int Mirror(int y, int height) { return y < 0 ? -y : y >= height ? 2 * (height - 1) - y : y; }

  const int stride_;
  std::vector<std::uint8_t> pixels_;
};

std::uint8_t Clamp16(int sixteenths) {
  return static_cast<std::uint8_t>(std::clamp((sixteenths + 8) >> 4, 0, 255));
}

/// The sums from which all four filters are made, around one pixel. `s` is the stride.
struct Neighbourhood {
  int centre, cross, diagonal, far_horizontal, far_vertical, left_right, up_down;

  Neighbourhood(const std::uint8_t* p, int s)
      : centre(p[0]),
        cross(p[-1] + p[1] + p[-s] + p[s]),
        diagonal(p[-s - 1] + p[-s + 1] + p[s - 1] + p[s + 1]),
        far_horizontal(p[-2] + p[2]),
        far_vertical(p[-2 * s] + p[2 * s]),
        left_right(p[-1] + p[1]),
        up_down(p[-s] + p[s]) {}

  /// Green where red or blue was measured; the other one of red and blue there.
  std::uint8_t Green() const { return Clamp16(8 * centre + 4 * cross - 2 * (far_horizontal + far_vertical)); }
  std::uint8_t Opposite() const { return Clamp16(12 * centre + 4 * diagonal - 3 * (far_horizontal + far_vertical)); }
  /// Where green was measured: the colour whose pixels lie left and right, or above and below.
  std::uint8_t FromRow() const {
    return Clamp16(10 * centre + 8 * left_right - 2 * (far_horizontal + diagonal) + far_vertical);
  }
  std::uint8_t FromColumn() const {
    return Clamp16(10 * centre + 8 * up_down - 2 * (far_vertical + diagonal) + far_horizontal);
  }
};

/// Where red lies in the 2 x 2 cell.
struct RedPlace {
  int x, y;
};

RedPlace RedOf(FrameLayout layout) {
  switch (layout) {
    case FrameLayout::kBayerGr:
      return {1, 0};
    case FrameLayout::kBayerGb:
      return {0, 1};
    case FrameLayout::kBayerBg:
      return {1, 1};
    default:
      return {0, 0};
  }
}

void DevelopRow(const PaddedMosaic& mosaic, RedPlace red, int y, RgbImage& image) {
  const bool red_row = (y & 1) == red.y;
  const std::uint8_t* in = mosaic.At(y);
  std::uint8_t* out = image.Row(y);
  for (int x = 0; x < image.width(); ++x, out += 3) {
    const Neighbourhood n(in + x, mosaic.stride());
    const bool red_column = (x & 1) == red.x;
    const int measured = red_row ? 0 : 2;  // of the row's own colour, the other is 2 - measured
    if (red_row == red_column) {
      out[measured] = in[x], out[1] = n.Green(), out[2 - measured] = n.Opposite();
    } else {
      out[1] = in[x], out[measured] = n.FromRow(), out[2 - measured] = n.FromColumn();
    }
  }
}

void CopyRow(const RawFrame& frame, int y, RgbImage& image) {
  const std::size_t row = static_cast<std::size_t>(y) * frame.width;
  if (frame.layout == FrameLayout::kRgb) {
    std::memcpy(image.Row(y), frame.bytes.data() + 3 * row, static_cast<std::size_t>(frame.width) * 3);
    return;
  }
  for (int x = 0; x < frame.width; ++x) std::fill_n(image.Row(y) + 3 * x, 3, frame.bytes[row + x]);
}

}  // namespace

Result<RgbImage> DevelopFrame(const RawFrame& frame) {
  const int samples = frame.layout == FrameLayout::kRgb ? 3 : 1;
  const std::size_t expected = std::size_t(std::max(frame.width, 0)) * std::max(frame.height, 0) * samples;
  if (frame.width < 4 || frame.height < 4 || frame.bytes.size() != expected) {
    return Internal("bad_frame", "a frame of " + std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                                     " has " + std::to_string(frame.bytes.size()) + " bytes");
  }
  RgbImage image(frame.width, frame.height, 3);
  if (samples == 3 || frame.layout == FrameLayout::kMono) {
    for (int y = 0; y < frame.height; ++y) CopyRow(frame, y, image);
    return image;
  }
  const PaddedMosaic mosaic(frame);
  for (int y = 0; y < frame.height; ++y) DevelopRow(mosaic, RedOf(frame.layout), y, image);
  return image;
}

}  // namespace drupe
