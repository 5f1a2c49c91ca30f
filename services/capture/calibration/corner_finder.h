#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/status.h"
#include "capture/calibration/checkerboard.h"
#include "image/image.h"

namespace drupe {

/// Inner corners of the pattern in one picture, in the order of Checkerboard::CornerMm.
struct PatternCorners {
  std::vector<int> indices;             ///< ascending; corners at the picture's border may be left out
  std::vector<Eigen::Vector2d> pixels;  ///< one for each index; pixel centres at integers

  std::size_t size() const { return indices.size(); }
};

/// How the pattern is looked for.
struct CornerFinderOptions {
  /// Wider pictures are reduced to this width to find the pattern; corners are always measured at full resolution.
  int search_width_px = 1280;
  /// Half the side of the window in which a corner is measured, in sides of a square: below 0.5, so that no other
  /// corner comes in.
  double window_squares = 0.3;

  Status Check() const;
};

/// Finds the pattern: all of a checkerboard, or what is visible of a ChArUco board. Empty when it is not there. Errors:
/// 500 `pattern_search_failed`.
Result<PatternCorners> FindCorners(const GrayImage& image, const Checkerboard& pattern,
                                   const CornerFinderOptions& options = {});

}  // namespace drupe
