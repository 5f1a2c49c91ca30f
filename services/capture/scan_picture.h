#pragma once

#include "capture/scan_run.h"
#include "image/image.h"

namespace drupe {

/// A developed frame, its checks, and when it was exposed.
struct ScanRun::Picture {
  RgbImage image;
  FrameCheck check;
  std::int64_t taken_ms = 0;
};

}  // namespace drupe
