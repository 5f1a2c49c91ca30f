#pragma once

#include "capture/calibration_session.h"
#include "capture/rig_state.h"
#include "capture/routes.h"

namespace drupe {

/// What the routes of calibration sessions work on; everything outlives the server.
struct SessionContext {
  CaptureContext capture;
  SessionStore& sessions;
  RigState& rig;
};

/// POST /calibration-sessions, GET and DELETE /calibration-sessions/ID, POST /calibration-sessions/ID/frames and
/// /calibration-sessions/ID/finish, GET /calibration-sessions/ID/preview.jpg.
void AddSessionRoutes(Router& router, const SessionContext& context);

}  // namespace drupe
