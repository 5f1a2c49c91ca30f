#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "capture/calibration/checkerboard.h"
#include "capture/calibration/corner_finder.h"
#include "capture/calibration/coverage.h"

namespace drupe {

/// How the pattern lies in a picture, as far as one can say before the camera is calibrated.
struct PatternPose {
  double tilt_deg = 0;  ///< between the pattern's normal and the line of sight to its middle, 0..90
  double nearer_x = 0;  ///< unit vector in the picture towards the side that is nearer to the camera; y points down
  double nearer_y = 0;
  double distance = 0;  ///< to its middle, in widths of the pattern
  double fill = 0;      ///< width or height of its outline over the picture's, the larger
  double centre_x = 0;  ///< of its middle, over the picture's width and height
  double centre_y = 0;
};
Json ToJson(const PatternPose& pose);

/// A pose that is still missing, in words and numbers.
struct MissingPose {
  std::string kind;  ///< "pictures", "tilt", "distance", "fill", "coverage"
  std::string side;  ///< of a tilt: "left", "right", "top", "bottom"; of coverage: a ninth of the picture; else empty
  double have = 0;   ///< the best so far
  double need = 0;
  std::string advice;  ///< what to do next, for the person who holds the pattern
};

/// What the pictures of a calibration so far lack.
struct Guidance {
  std::vector<PatternPose> poses;  ///< of the pictures, in their order
  CoverageMap coverage;
  std::vector<MissingPose> missing;  ///< the most useful first; empty: the calibration can be made
};
/// {"complete", "missing": [{"kind", "side", "have", "need", "advice"}], "coverage": CoverageMap, "coverage_pct"}
Json ToJson(const Guidance& guidance);

/// Looks at the corners found in pictures of width x height. The focal length is guessed from the perspective in them,
/// with square pixels and the principal point in the middle (Zhang 2000, section 3.1), which is good for a few degrees.
Guidance Guide(const std::vector<PatternCorners>& pictures, const Checkerboard& pattern, int width, int height);

/// The first of `kept` that shows nearly the same as `pose`; -1: none does.
int SimilarPose(const PatternPose& pose, const std::vector<PatternPose>& kept);

}  // namespace drupe
