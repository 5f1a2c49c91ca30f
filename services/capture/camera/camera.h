#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "capture/camera/camera_options.h"
#include "capture/camera/raw_frame.h"

namespace drupe {

/// What became of the frames and packets of a camera since it was opened.
struct CameraCounters {
  std::int64_t frames = 0;             ///< complete
  std::int64_t incomplete_frames = 0;  ///< given up because packets were missing
  std::int64_t dropped_frames = 0;     ///< no buffer was free
  std::int64_t resent_packets = 0;     ///< lost, asked for, and come
  std::int64_t missing_packets = 0;    ///< lost for good
  std::int64_t timeouts = 0;           ///< NextFrame waited in vain
  std::int64_t reconnects = 0;

  CameraCounters& operator+=(const CameraCounters& other);
};
Json ToJson(const CameraCounters& counters);

/// What the camera is, for records.
struct CameraIdentity {
  std::string id;
  std::string vendor, model, serial;
};

/// A camera opened over Aravis (GigE Vision or USB3 Vision), taking frames into buffers of bounded number. Errors of
/// every call: 503 `camera_lost` (no longer reachable, or taken over by somebody else).
class Camera {
 public:
  /// `id` is that of CameraDirectory, or an IP address; empty takes the only camera there is. Errors: 404
  /// `camera_not_found`, 503 `camera_busy` (another program controls it), 422 `camera_refused` (an option that it does
  /// not have or a value outside its range, in its own words).
  static Result<std::unique_ptr<Camera>> Open(const std::string& id, const CameraOptions& options);
  virtual ~Camera() = default;

  virtual const CameraIdentity& identity() const = 0;
  virtual int width() const = 0;
  virtual int height() const = 0;

  /// Begins and ends the acquisition.
  virtual Status Start() = 0;
  virtual Status Stop() = 0;
  /// Asks for one frame, with the software trigger.
  virtual Status FireTrigger() = 0;
  /// The next complete frame. Errors: 503 `frame_timeout` (none came), 503 `frame_incomplete` (packets were lost for
  /// good), 503 `camera_lost`.
  virtual Result<RawFrame> NextFrame(std::chrono::milliseconds timeout) = 0;
  /// Forgets frames that have arrived and were not asked for.
  virtual void DiscardFrames() = 0;
  virtual CameraCounters counters() const = 0;
};

}  // namespace drupe
