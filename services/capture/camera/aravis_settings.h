#pragma once

#include "base/status.h"
#include "capture/camera/camera_options.h"

typedef struct _ArvCamera ArvCamera;

namespace drupe {

/// Sets region, pixel format, exposure, gain, frame rate, trigger and packet size. Bayer takes the pattern that the
/// camera offers. Errors: 422 `camera_refused`, 503 `camera_lost`, `camera_busy`.
Status ApplyCameraOptions(ArvCamera* camera, const CameraOptions& options);

}  // namespace drupe
