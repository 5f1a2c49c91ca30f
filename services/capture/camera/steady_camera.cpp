#include "capture/camera/steady_camera.h"

#include <thread>

#include "base/log.h"

namespace drupe {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr int kBarrenShots = 3;
constexpr std::chrono::milliseconds kShotPatience{2'000};  // and the exposure

/// Errors of opening that pass by themselves: it is unplugged, or still held by a controller that has died.
bool MayPass(const Status& status) {
  return status.code() == "camera_not_found" || status.code() == "camera_busy" || status.code() == "camera_lost" ||
         status.code() == "camera_refused";
}

bool IsShotToRepeat(const Status& status) {
  return status.code() == "camera_lost" || status.code() == "frame_timeout" || status.code() == "frame_incomplete";
}

}  // namespace

SteadyCamera::SteadyCamera(std::string id, const CameraOptions& options, const SteadyCameraOptions& steady,
                           Cancelled cancelled)
    : id_(std::move(id)), options_(options), steady_(steady), cancelled_(std::move(cancelled)) {}

CameraCounters SteadyCamera::counters() const {
  CameraCounters sum = past_;
  if (camera_) sum += camera_->counters();
  return sum;
}

Status SteadyCamera::OpenOnce() {
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<Camera> camera, Camera::Open(id_, options_));
  DRUPE_RETURN_IF_ERROR(camera->Start());
  identity_ = camera->identity();
  width_ = camera->width(), height_ = camera->height();
  if (was_open_) {
    ++past_.reconnects;
    Log(LogLevel::kInfo, "the camera is back", {{"camera", identity_.id}});
  }
  was_open_ = true;
  camera_ = std::move(camera);
  return Status::Ok();
}

Status SteadyCamera::Ensure() {
  const auto deadline = SteadyClock::now() + steady_.patience;
  while (!camera_) {
    const Status status = OpenOnce();
    if (status.ok()) break;
    // A refusal while the camera starts up passes; one at the first opening is the user's to hear.
    if (!MayPass(status) || (!was_open_ && status.code() == "camera_refused")) return status;
    if (cancelled_ && cancelled_()) return drupe::Cancelled();
    if (SteadyClock::now() >= deadline) return {StatusKind::kUnavailable, "camera_away", status.message(), "camera"};
    std::this_thread::sleep_for(steady_.retry);
  }
  return Status::Ok();
}

Status SteadyCamera::Note(Status status) {
  if (status.code() != "camera_lost" && status.code() != "camera_busy" && barren_ < kBarrenShots) return status;
  Log(LogLevel::kWarning, "the camera is lost", {{"camera", identity_.id}, {"error", status.ToString()}});
  past_ += camera_->counters();
  camera_.reset();
  barren_ = 0;
  return {StatusKind::kUnavailable, "camera_lost", status.message()};
}

Result<RawFrame> SteadyCamera::NextFrame(std::chrono::milliseconds timeout) {
  DRUPE_RETURN_IF_ERROR(Ensure());
  Result<RawFrame> frame = camera_->NextFrame(timeout);
  if (!frame.ok()) return Note(frame.status());
  barren_ = 0;
  return frame;
}

void SteadyCamera::Discard() {
  if (camera_) camera_->DiscardFrames();
}

Result<RawFrame> SteadyCamera::Shoot(std::chrono::milliseconds timeout) {
  DRUPE_RETURN_IF_ERROR(Ensure());
  Discard();
  ++barren_;
  if (const Status fired = camera_->FireTrigger(); !fired.ok()) return Note(fired);
  return NextFrame(timeout);
}

Result<RawFrame> SteadyCamera::ShootPatiently(int tries) {
  const auto exposure_ms = static_cast<int>(options_.exposure_us.value_or(0) / 1000);
  Result<RawFrame> frame = Shoot(kShotPatience + std::chrono::milliseconds(exposure_ms));
  for (int i = 1; i < tries && IsShotToRepeat(frame.status()); ++i) {
    if (cancelled_ && cancelled_()) return drupe::Cancelled();
    frame = Shoot(kShotPatience + std::chrono::milliseconds(exposure_ms));
  }
  return frame;
}

}  // namespace drupe
