#pragma once

#include "base/json.h"
#include "base/status.h"
#include "geometry/pinhole_camera.h"

namespace drupe {

/// The content of calibration.json: {"width", "height", "K": 3x3, "dist": [k1, k2, p1, p2, k3], "rms_px"}.
struct Calibration {
  PinholeCamera camera;
  double rms_px = 0;  ///< reprojection error of the calibration; 0 when unknown
};

/// Reads and checks calibration.json. Errors: 400 `invalid_calibration` with the field that is wrong (sizes outside the
/// image limits, focal lengths not positive, principal point outside the picture, skew, non-finite numbers).
Result<Calibration> ParseCalibration(const Json& json);

Json ToJson(const Calibration& calibration);

/// Refuses a calibration made for another picture size: 422 `calibration_size_mismatch`, with both sizes.
Status CheckCalibrationSize(const Calibration& calibration, int width, int height);

}  // namespace drupe
