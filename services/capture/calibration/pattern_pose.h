#pragma once

#include <Eigen/Core>
#include <optional>

#include "capture/calibration/guidance.h"

namespace drupe {

/// The map from the pattern's plane to a picture: of (x, y, 1), in widths of the pattern from its middle, to pixels
/// from the picture's middle over the picture's width. Scaled so that its last element is 1.
using PatternMap = Eigen::Matrix3d;

/// Nothing when the corners do not determine it.
std::optional<PatternMap> MapOf(const PatternCorners& corners, const Checkerboard& pattern, int width, int height);

/// Focal length over the picture's width that explains the perspective in the pictures best; 1.2, which many cameras
/// have, when they show too little of it.
double GuessFocal(const std::vector<PatternMap>& maps);

PatternPose PoseOf(const PatternMap& map, double focal, const Checkerboard& pattern, int width, int height);

}  // namespace drupe
