#pragma once

#include "capture/rig_state.h"
#include "capture/routes.h"
#include "capture/scan_store.h"

namespace drupe {

/// What the routes of scans work on; everything outlives the server.
struct ScanContext {
  CaptureContext capture;
  ScanStore& scans;
  RigState& rig;
};

/// POST and GET /scans, GET and DELETE /scans/ID, POST /scans/ID/resume, GET /scans/ID/events, /scans/ID/preview.jpg,
/// /scans/ID/preview.mjpeg, /scans/ID/frames/NAME, POST /turntable/stop.
void AddScanRoutes(Router& router, const ScanContext& context);

}  // namespace drupe
