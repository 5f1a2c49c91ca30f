#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "capture/camera/camera.h"

namespace drupe {

struct SteadyCameraOptions {
  std::chrono::milliseconds patience{60'000};  ///< how long a camera that is away is waited for
  std::chrono::milliseconds retry{300};        ///< between two attempts to reach it
};

/// A camera that comes back: when it is lost, it is opened and started again with the same options as soon as it
/// answers, and the loss is counted. Not thread-safe.
class SteadyCamera {
 public:
  using Cancelled = std::function<bool()>;

  SteadyCamera(std::string id, const CameraOptions& options, const SteadyCameraOptions& steady, Cancelled cancelled);

  /// Opens and starts it if it is not running. Errors: 503 `camera_away` when patience is over, `cancelled`, and those
  /// of Camera::Open that waiting does not help.
  Status Ensure();
  /// As Camera::NextFrame; a camera that is lost is closed, and the next Ensure opens it again.
  Result<RawFrame> NextFrame(std::chrono::milliseconds timeout);
  /// Forgets the frames that have come and were not taken.
  void Discard();
  /// Discards, fires the software trigger and waits for the frame. A camera that misses three shots is taken for lost.
  Result<RawFrame> Shoot(std::chrono::milliseconds timeout);

  /// Shoots until a frame comes: lost packets, and a camera that goes and comes back, pass by themselves. Errors: those
  /// of the last of `tries`, `cancelled`, and those that another try does not help.
  Result<RawFrame> ShootPatiently(int tries);

  const CameraIdentity& identity() const { return identity_; }
  int width() const { return width_; }
  int height() const { return height_; }
  CameraCounters counters() const;

 private:
  Status OpenOnce();
  /// Closes the camera if `status` says that it is lost; returns `status`.
  Status Note(Status status);

  const std::string id_;
  const CameraOptions options_;
  const SteadyCameraOptions steady_;
  const Cancelled cancelled_;
  std::unique_ptr<Camera> camera_;
  CameraIdentity identity_;
  CameraCounters past_;
  int width_ = 0, height_ = 0;
  bool was_open_ = false;
  int barren_ = 0;  ///< shots without a frame, one after the other
};

}  // namespace drupe
