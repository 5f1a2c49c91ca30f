#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/limits.h"
#include "base/status.h"
#include "capture/calibration/checkerboard.h"
#include "capture/camera_binding.h"
#include "http/request.h"
#include "store/object_store.h"

namespace drupe {

/// A picture of the pattern in the object store.
struct StoredPicture {
  std::string name;
  std::string sha256;
};

/// A picture that intake refused.
struct RefusedPicture {
  std::string name;
  std::string code;
  std::string message;
};

/// What a calibration is asked to work on; the payload of its job.
struct CalibrationRequest {
  Checkerboard pattern;
  CameraBinding camera;
  std::vector<StoredPicture> pictures;  ///< ascending by name
  std::vector<RefusedPicture> refused;
};

Json ToJson(const CalibrationRequest& request);
/// Reads what ToJson wrote. Errors: 500 `bad_payload`.
Result<CalibrationRequest> ParseCalibrationPayload(const Json& payload);

/// Reads a multipart form: `images`, 3 to 100 files, each verified and stored as it comes, `pattern`, JSON, and if the
/// caller wishes `camera`, the JSON of ParseCameraBinding. A
/// picture that is broken is refused by name and the others are kept. Errors: 400 `invalid_name`, `duplicate_name`,
/// `duplicate_part`, `unknown_part`, `missing_part`, `too_few_images`; those of ParseCheckerboard, ParseCameraBinding
/// and of the store; the first refusal's own when too few pictures remain.
Result<CalibrationRequest> ReadCalibrationForm(const Request& http, ObjectStore& objects, const Limits& limits);

}  // namespace drupe
