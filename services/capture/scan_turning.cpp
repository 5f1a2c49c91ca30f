#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "capture/scan/angle_track.h"
#include "capture/scan_picture.h"
#include "capture/scan_run.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr int kMaxSweeps = 8;
constexpr double kLeadSteps = 1.0;       // the table begins this much before the first view that is missing
constexpr double kOverrunSteps = 0.6;    // and ends this much behind the last
constexpr double kMaxErrorSteps = 0.35;  // an angle farther from its view than this belongs to none
constexpr milliseconds kFrameSlice{60};
constexpr milliseconds kLastFrames{1'500};  // for what is still on the line when the table rests

}  // namespace

Status ScanRun::TakeTurning() {
  for (int sweep = 0; sweep < kMaxSweeps && !missing_.empty(); ++sweep) {
    DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
    DRUPE_RETURN_IF_ERROR(Sweep());
    DRUPE_RETURN_IF_ERROR(SaveCounters());
  }
  if (missing_.empty()) return Status::Ok();
  return {StatusKind::kUnavailable, "views_missing",
          std::to_string(missing_.size()) + " views are missing after " + std::to_string(kMaxSweeps) +
              " turns; check the trigger line and the network"};
}

/// One pass over the angles from the first to the last view that is missing, always forward.
Status ScanRun::Sweep() {
  DRUPE_ASSIGN_OR_RETURN(const TableReading now, table_->Read());
  const double step = request_.step_deg(), phase = phase_deg_.value_or(0);
  double from = (*missing_.begin() - kLeadSteps) * step + phase;
  double end = (*missing_.rbegin() + kOverrunSteps) * step + phase;
  if (!table_->can_position()) {
    from = now.angle_deg, end = from + 360 + step;
  } else if (now.angle_deg > from) {
    const double turns = std::ceil((now.angle_deg - from) / 360 - 1e-3);
    from += 360 * turns, end += 360 * turns;
  }
  if (table_->can_position()) {
    DRUPE_RETURN_IF_ERROR(table_->MoveTo(from, [this] { return context_.IsCancelled(); }));
  }
  DRUPE_RETURN_IF_ERROR(camera_.Ensure());
  camera_.Discard();
  DRUPE_RETURN_IF_ERROR(table_->StartTurn(end, request_.turning_deg_s()));
  return WatchTurn(end);
}

/// Takes the frames that come while the table turns to `end_deg`.
Status ScanRun::WatchTurn(double end_deg) {
  AngleTrack track(request_.turning_deg_s());
  const SteadyClock::time_point start = SteadyClock::now();
  SteadyClock::time_point rested = SteadyClock::time_point::max();
  while (!missing_.empty()) {
    DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
    DRUPE_ASSIGN_OR_RETURN(const TableReading before, table_->Read());
    track.Add(before.at, before.angle_deg, before.moving);
    const Result<RawFrame> frame = camera_.NextFrame(kFrameSlice);
    DRUPE_ASSIGN_OR_RETURN(const TableReading after, table_->Read());
    track.Add(after.at, after.angle_deg, after.moving);
    if (frame.ok() && frame->exposed > start) {
      const std::optional<double> angle =
          table_->can_position() ? track.AngleAt(frame->exposed) : AngleByPulses(*frame);
      if (angle) DRUPE_RETURN_IF_ERROR(TakeTurningFrame(*frame, *angle));
    } else if (!frame.ok() && frame.status().code() == "camera_away") {
      return frame.status();
    }
    const bool ended = table_->can_position() ? !after.moving : after.angle_deg >= end_deg;
    if (!ended) rested = SteadyClock::time_point::max();
    if (ended && rested == SteadyClock::time_point::max()) rested = SteadyClock::now();
    if (ended && SteadyClock::now() - rested > (table_->can_position() ? kLastFrames : milliseconds(0))) break;
  }
  return Status::Ok();
}

/// Where a table that says nothing stands is told by its pulses: from one frame to the next it turned by as many steps
/// as fit the time best, so that a speed which is not quite what was asked for does not add up.
double ScanRun::AngleByPulses(const RawFrame& frame) {
  Pulse pulse{frame.exposed, 0};
  if (last_pulse_) {
    const double seconds = std::chrono::duration<double>(frame.exposed - last_pulse_->exposed).count();
    const double steps = std::max(1.0, std::round(seconds * request_.turning_deg_s() / request_.step_deg()));
    pulse.angle_deg = last_pulse_->angle_deg + steps * request_.step_deg();
  }
  last_pulse_ = pulse;
  return pulse.angle_deg;
}

Status ScanRun::TakeTurningFrame(const RawFrame& frame, double angle_deg) {
  ViewOfAngle place = NearestView(angle_deg - phase_deg_.value_or(0), request_.views);
  if (!phase_deg_) phase_deg_ = place.error_deg, place.error_deg = 0;
  if (std::abs(place.error_deg) > kMaxErrorSteps * request_.step_deg()) {
    Log(LogLevel::kWarning, "a frame lies between two views",
        {{"scan", id_}, {"angle_deg", angle_deg}, {"view", place.view}});
    return Status::Ok();
  }
  if (missing_.count(place.view) == 0) return Status::Ok();
  const double exposure_s = request_.camera.exposure_us.value_or(0) * 1e-6;
  DRUPE_ASSIGN_OR_RETURN(const Picture picture,
                         Develop(frame, PixelsOfTurn(request_.turning_deg_s() * exposure_s), true));
  if (!picture.check.ok()) {
    Log(LogLevel::kWarning, "a frame has faults",
        {{"scan", id_}, {"view", place.view}, {"faults", picture.check.faults}});
  }
  return Keep(place.view, angle_deg, picture, 1);
}

}  // namespace drupe
