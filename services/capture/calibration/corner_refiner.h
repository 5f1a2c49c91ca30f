#pragma once

#include "capture/calibration/checkerboard.h"
#include "capture/calibration/corner_finder.h"
#include "geometry/pinhole_camera.h"
#include "geometry/rigid3.h"
#include "image/image.h"

namespace drupe {

/// Measures corners again with the camera and pose that a first calibration gave.
///
/// On the pattern's plane the four edges that meet in a corner run along the axes, whatever perspective and lens do to
/// them in the picture. Each edge is crossed by short profiles; on a profile the edge is where two plateaus of equal
/// area meet (Tabatabai & Mitchell 1984), which symmetric blur does not move. The corner is where the means of opposite
/// edges agree: what light and dark squares' different growth (print gain, gamma, overexposure) does to one edge it
/// does to the opposite one with the other sign. Corners whose edges leave the picture or are not clear are left out.
PatternCorners RefineCorners(const GrayImage& image, const Checkerboard& pattern, const PatternCorners& corners,
                             const PinholeCamera& camera, const Rigid3& cam_from_pattern);

}  // namespace drupe
