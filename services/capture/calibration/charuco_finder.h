#pragma once

#include "capture/calibration/checkerboard.h"
#include "capture/calibration/corner_finder.h"

namespace cv {
class Mat;
}

namespace drupe {

/// Where the corners of a ChArUco board lie to a pixel or so: each is placed by the plane-to-picture map of the markers
/// around it, of which one at least must touch it. Empty when there are too few to tell the board's pose. May throw
/// cv::Exception.
PatternCorners FindCharucoCorners(const cv::Mat& picture, const Checkerboard& pattern);

}  // namespace drupe
