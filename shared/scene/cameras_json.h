#pragma once

#include "base/json.h"
#include "base/status.h"
#include "scene/sparse_model.h"

namespace drupe {

/// The content of cameras.json: {"unit", "frame", "scale_source", "calibration", "cameras": [{"image", "R", "t",
/// "registered", "mean_reprojection_error_px", "observations", "centre_sigma", "rotation_sigma_deg", "reason"}]} with
/// x_cam = R X + t. The sigmas, left out where not known, are standard uncertainties: of the camera's centre in `unit`,
/// of the rotation's angle in degrees. `unit` and `frame` are "mm" and "board" for a metric model, otherwise "arbitrary"
/// and "first_view". R and t are null for a view that is not registered; `reason` says why.
Json CamerasJson(const SparseModel& model);

/// Reads cameras.json back: a model without tracks. Errors: 400 `invalid_cameras` with the field that is wrong.
Result<SparseModel> ParseCameras(const Json& json);

}  // namespace drupe
