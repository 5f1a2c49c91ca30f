#pragma once

#include <string>
#include <string_view>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// The camera, and the setting of its lens, that a calibration was made with. What is empty is not known.
struct CameraBinding {
  std::string serial;  ///< of the camera
  std::string lens;    ///< in the user's words, such as "25 mm, f/8, 0.30 m"
};

/// Reads {"serial", "lens"}, both optional, at most 128 characters each. Errors: 400 `invalid_option`,
/// `unknown_option`.
Result<CameraBinding> ParseCameraBinding(const Json& json);
/// {"serial": text or null, "lens": text or null}
Json ToJson(const CameraBinding& binding);

/// Refuses a calibration made with another camera (422 `calibration_camera_mismatch`) or at another setting of the lens
/// (422 `calibration_lens_mismatch`), as far as both sides are known.
Status CheckBinding(const CameraBinding& calibration, const CameraBinding& used);

}  // namespace drupe
