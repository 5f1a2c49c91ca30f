#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "base/status.h"
#include "image/image.h"

namespace drupe {

/// Which colour filters lie over the top left 2 x 2 pixels.
enum class FrameLayout { kMono, kRgb, kBayerGr, kBayerRg, kBayerGb, kBayerBg };

/// A picture as the camera sent it: rows without padding, 8 bits a sample.
struct RawFrame {
  int width = 0, height = 0;
  FrameLayout layout = FrameLayout::kMono;
  std::vector<std::uint8_t> bytes;
  std::uint64_t id = 0;                           ///< the camera's own number of the frame
  std::chrono::steady_clock::time_point exposed;  ///< by our clock; when it came, if the camera gives no time stamps
};

/// The frame in colour; mosaics are interpolated (Demosaic). Errors: 500 `bad_frame` when the bytes are not as many as
/// the size says.
Result<RgbImage> DevelopFrame(const RawFrame& frame);

}  // namespace drupe
