#pragma once

#include <string>

#include "base/json.h"
#include "base/status.h"
#include "capture/camera/camera_options.h"
#include "capture/camera_binding.h"
#include "capture/scan/frame_check.h"
#include "capture/turntable/turntable.h"

namespace drupe {

enum class ScanMode {
  kStep,        ///< turn, settle, shoot
  kContinuous,  ///< the table turns evenly and its pulses trigger the camera
};

/// What POST /scans asks for; the payload of the job.
struct ScanRequest {
  std::string camera_id;  ///< empty: the only camera there is
  CameraOptions camera;
  bool table_turns_by_itself = false;  ///< "external": nothing can be told to it
  TurntableOptions table;
  int views = 36;  ///< 3..400, evenly over the turn
  ScanMode mode = ScanMode::kStep;
  double turn_s = 30;  ///< of a continuous turn, 5..3600 (the paper's section 2.2)
  int retakes = 2;     ///< of a frame found wanting, in step mode, 0..10
  FrameCheckOptions checks;
  int jpeg_quality = 97;          ///< 50..100, with full colour resolution
  Json calibration;               ///< calibration.json, or null
  CameraBinding calibrated_for;   ///< what the calibration was made with, as far as it is known
  std::string lens;               ///< the lens's setting now, in the user's words; empty: not told
  Json board = "default";         ///< "default", board.json, or null
  Json options = Json::object();  ///< of the reconstruction
  bool reconstruct = true;
  bool analyze = true;

  double step_deg() const { return 360.0 / views; }
  double turning_deg_s() const { return 360.0 / turn_s; }
  /// Errors: 400 `invalid_option` with the field.
  Status Check() const;
};

/// Reads the body of POST /scans. Everything is optional; "camera" may be an id or an object with "id" and camera
/// options, "turntable" may be "grbl" or "external" or an object with "driver" and options. "calibration" must be the
/// content already: whoever calls has looked up an id. Errors: 400 `invalid_option`, `unknown_option`,
/// `invalid_calibration`, `invalid_board`.
Result<ScanRequest> ParseScanRequest(const Json& json);
/// What ParseScanRequest reads.
Json ToJson(const ScanRequest& request);

}  // namespace drupe
