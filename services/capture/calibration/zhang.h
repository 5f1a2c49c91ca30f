#pragma once

#include <array>
#include <vector>

#include "base/status.h"
#include "capture/calibration/checkerboard.h"
#include "capture/calibration/corner_finder.h"
#include "geometry/pinhole_camera.h"
#include "geometry/rigid3.h"

namespace drupe {

/// Standard uncertainties of the intrinsics from the adjustment, scaled by the residuals; 0 for what was held fixed.
struct IntrinsicsSigma {
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::array<double, 5> dist{};           ///< k1, k2, p1, p2, k3
};

/// Intrinsics and poses from pictures of a plane.
struct ZhangSolution {
  PinholeCamera camera;
  IntrinsicsSigma sigma;
  std::vector<Rigid3> cam_from_pattern;  ///< per view; mm
  std::vector<double> view_rms_px;       ///< per view, over its corners
  double rms_px = 0;                     ///< over all corners
  bool square_pixels = false;            ///< fx = fy, because the data did not tell them apart
  bool fixed_k3 = false;                 ///< k3 = 0, because the data did not tell it from 0
};

/// Calibration from a plane in several poses (Zhang, "A flexible new technique for camera calibration", PAMI 2000),
/// with the lens model of PinholeCamera. k3, and the difference of fx and fy, are kept only when they are significant
/// (3 sigma): parameters that only fit noise move the others. Needs 3 views of 6 corners or more. Errors: 422
/// `calibration_failed`.
Result<ZhangSolution> SolveZhang(const std::vector<PatternCorners>& views, const Checkerboard& pattern, int width,
                                 int height);

}  // namespace drupe
