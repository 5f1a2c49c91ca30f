#pragma once

#include <string>

#include "base/limits.h"
#include "capture/calibration_store.h"
#include "capture/camera/camera_directory.h"
#include "http/router.h"
#include "jobs/job_store.h"
#include "store/object_store.h"

namespace drupe {

/// What the routes work on; everything outlives the server.
struct CaptureContext {
  ObjectStore& objects;
  JobStore& jobs;
  CameraDirectory& cameras;
  CalibrationStore& calibrations;
  Limits limits;
  std::string public_url;          ///< before the links to this service; empty: relative links
  std::string reconstruction_url;  ///< of the service that uses the calibrations
};

/// POST and GET /calibrations, GET /calibrations/ID, GET /calibrations/ID/calibration.json,
/// /calibrations/ID/coverage.png, GET /cameras. A calibration has two ids that serve alike: its job's, and its own.
void AddCaptureRoutes(Router& router, const CaptureContext& context);

}  // namespace drupe
