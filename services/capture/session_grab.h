#pragma once

#include <optional>
#include <string>

#include "capture/calibration_session.h"
#include "capture/camera/steady_camera.h"
#include "store/object_store.h"

namespace drupe {

/// What became of one picture of a session.
struct Grab {
  bool kept = false;
  std::string reason;  ///< why it was not kept; empty when it was
  int corners = 0;     ///< found in it
  std::optional<PatternPose> pose;
  std::string preview;  ///< the picture, reduced, with the corners, as JPEG
};
/// {"kept", "reason", "corners", "pose"}
Json ToJson(const Grab& grab);

/// Takes a picture with the session's camera, looks for the pattern, and adds the picture to the session when it shows
/// something new. Errors: those of SteadyCamera, 409 `camera_changed` (another one, or another picture size, than
/// before), 409 `session_full` (100 pictures), those of the object store.
Result<Grab> TakeSessionPicture(CalibrationSession& session, ObjectStore& objects, const SteadyCameraOptions& steady);

}  // namespace drupe
