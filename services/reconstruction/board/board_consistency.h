#pragma once

#include "geometry/pinhole_camera.h"
#include "scene/board.h"

namespace drupe {

/// Keeps the markers whose four corners agree with the homography from the board's plane to the picture, distortion
/// removed. A marker is dropped when a corner lies farther from its place than `max_error_share` of the marker's
/// longest side, or than five robust standard deviations of all corners (at least half a pixel). Fewer than three
/// markers, or a board that is not plane, are returned as they are: there is nothing to compare with.
BoardDetection KeepConsistentMarkers(const BoardDetection& markers, const Board& board, const PinholeCamera& camera,
                                     double max_error_share);

}  // namespace drupe
