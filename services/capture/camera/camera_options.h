#pragma once

#include <optional>
#include <string>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

enum class CameraPixelFormat { kMono8, kRgb8, kBayer };
enum class CameraTrigger {
  kFree,      ///< the camera's own frame rate
  kSoftware,  ///< a frame whenever Camera::FireTrigger says so
  kLine,      ///< a rising edge on `trigger_line`
};

/// A window of the sensor in pixels; all of it where width or height is 0.
struct CameraRegion {
  int x = 0, y = 0, width = 0, height = 0;
};

/// How a camera takes pictures. What is absent or 0 is left as the camera has it.
struct CameraOptions {
  CameraRegion region;
  /// Bayer needs a third of RGB's bandwidth and lets us choose how colours are interpolated.
  CameraPixelFormat pixel_format = CameraPixelFormat::kBayer;
  std::optional<double> exposure_us;  ///< 1..10^7
  std::optional<double> gain;         ///< in the camera's unit, usually dB, 0..48
  std::optional<double> frame_rate;   ///< frames a second when it runs free, 0.1..1000
  CameraTrigger trigger = CameraTrigger::kSoftware;
  std::string trigger_line = "Line1";
  /// Of the stream, 576..16000; every network carries 1400, jumbo frames need it set up. 0: try what it carries, which
  /// takes seconds.
  int packet_bytes = 1400;
  bool resend = true;          ///< ask again for lost packets
  int packet_timeout_ms = 20;  ///< a packet this late is asked for, 1..1000
  int frame_timeout_ms = 500;  ///< a frame whose packets stop coming for this long is given up, 10..10000
  int buffers = 8;             ///< frames under way at most, 2..64; more are dropped and counted

  /// Errors: 400 `invalid_option` with the field.
  Status Check() const;
};

/// Reads the options of a request: {"region": {"x", "y", "width", "height"}, "pixel_format": "bayer8" | "mono8" |
/// "rgb8", "exposure_us", "gain", "trigger_line", "packet_bytes", "resend", ...}. The trigger is the scan's business.
/// Errors: 400 `invalid_option`, `unknown_option`.
Result<CameraOptions> ParseCameraOptions(const Json& json);
Json ToJson(const CameraOptions& options);

/// A camera and how it takes pictures.
struct CameraChoice {
  std::string id;  ///< empty: the only camera there is
  CameraOptions options;
};

/// Reads what requests call "camera": an id of at most 128 characters, or the options with "id" among them, or null for
/// the defaults. Errors: those of ParseCameraOptions.
Result<CameraChoice> ParseCameraChoice(const Json& json);
/// The options with "id".
Json ToJson(const CameraChoice& choice);

}  // namespace drupe
