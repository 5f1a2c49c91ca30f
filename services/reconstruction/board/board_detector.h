#pragma once

#include <optional>

#include "base/status.h"
#include "geometry/pinhole_camera.h"
#include "image/image.h"
#include "scene/board.h"

namespace drupe {

/// How the markers of the board are looked for.
struct BoardDetectorOptions {
  /// Width in pixels of the reduced picture in which markers are searched; corners are always measured at full
  /// resolution. Wider pictures are reduced by the smallest whole factor that makes them no wider.
  int search_width_px = 1280;
  /// Smallest side of a marker in the reduced picture, pixels.
  double min_marker_side_px = 12.0;
  /// A marker is dropped when one of its corners lies farther than this from where the board's homography puts it, in
  /// units of the marker's longest side. Generous, because the homography only has to catch wrong ids and bad corners.
  double max_homography_error_share = 0.04;
  /// Lens distortion is removed with this before the homography is fitted; nothing: taken as zero.
  std::optional<PinholeCamera> camera;

  /// The message names the option, its value and its range.
  Status Check() const;
};

/// Finds the board's ArUco markers in a picture. Ids ascending, corners in pixels of `image` (pixel centres at
/// integers), in the order of Board::corners_mm. An empty detection means that no marker is visible; that is not an
/// error. Errors: 400 for options out of range, 500 `board_detection_failed` when OpenCV throws.
///
/// Markers are found by cv::aruco (Garrido-Jurado et al. 2014) in a reduced picture; each side is then measured at full
/// resolution by fitting a line to sub-pixel edge positions, and corners are intersections of neighbouring sides, which
/// has no bias from the window that cornerSubPix has on small, foreshortened markers. Markers that contradict the
/// homography from the board to the picture (wrong id, hidden or damaged side) are dropped.
Result<BoardDetection> DetectBoard(const GrayImage& image, const Board& board,
                                   const BoardDetectorOptions& options = {});

}  // namespace drupe
