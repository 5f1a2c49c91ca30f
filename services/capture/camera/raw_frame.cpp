#include "capture/camera/raw_frame.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "capture/camera/demosaic.h"

namespace drupe {
namespace {

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
  if (samples == 1 && frame.layout != FrameLayout::kMono) {
    return Demosaic(frame.bytes.data(), frame.width, frame.height, RedOf(frame.layout));
  }
  RgbImage image(frame.width, frame.height, 3);
  for (int y = 0; y < frame.height; ++y) CopyRow(frame, y, image);
  return image;
}

}  // namespace drupe
