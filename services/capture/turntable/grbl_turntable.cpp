#include "capture/turntable/grbl_turntable.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <thread>

namespace drupe {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr milliseconds kReplyPatience{2'000};
constexpr milliseconds kHomingPatience{120'000};
constexpr milliseconds kPoll{20};
constexpr int kReadings = 6;
constexpr milliseconds kUsualDelay{1};      // in the time of an answer
constexpr double kSmallestMoveDeg = 0.002;  // below it GRBL rounds a move to nothing
constexpr char kSoftReset = '\x18';

Status Alarm(const std::string& what) {
  return {StatusKind::kConflict, "table_alarm",
          "the turntable has stopped with " + what + "; look what blocks it, then resume the scan"};
}

Status Silent() {
  return {StatusKind::kUnavailable, "table_unreachable", "the turntable does not answer"};
}

}  // namespace

Status GrblOptions::Check() const {
  if (device.empty()) return InvalidArgument("invalid_option", "the turntable's device is missing", "device");
  if (std::string_view("XYZABC").find(axis) != std::string_view::npos) return Status::Ok();
  return InvalidArgument("invalid_option", "the axis must be one of X Y Z A B C", "axis");
}

Result<std::unique_ptr<GrblTurntable>> GrblTurntable::Open(const GrblOptions& grbl, const TurntableOptions& options) {
  DRUPE_RETURN_IF_ERROR(grbl.Check());
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<SerialLine> line, SerialLine::Open(grbl.device, grbl.baud));
  return std::unique_ptr<GrblTurntable>(new GrblTurntable(std::move(line), grbl, options));
}

Status GrblTurntable::Command(const std::string& command, milliseconds patience) {
  const std::lock_guard lock(mutex_);
  DRUPE_RETURN_IF_ERROR(line_->Write(command + "\n"));
  const auto deadline = SteadyClock::now() + patience;
  while (SteadyClock::now() < deadline) {
    DRUPE_ASSIGN_OR_RETURN(const std::optional<std::string> line, line_->ReadLine(kPoll));
    if (!line) continue;
    if (*line == "ok") return Status::Ok();
    if (line->starts_with("ALARM:")) return Alarm(*line);
    if (*line == "error:9") return Alarm("an alarm from before (locked)");
    if (line->starts_with("error:")) {
      return Unprocessable("table_refused", "the turntable answers " + *line + " to " + command);
    }
  }
  return Silent();
}

Result<GrblStatus> GrblTurntable::Query() {
  const std::lock_guard lock(mutex_);
  DRUPE_RETURN_IF_ERROR(line_->Write("?"));
  const auto deadline = SteadyClock::now() + kReplyPatience;
  while (SteadyClock::now() < deadline) {
    DRUPE_ASSIGN_OR_RETURN(const std::optional<std::string> line, line_->ReadLine(kPoll));
    if (!line) continue;
    if (line->starts_with("ALARM:")) return Alarm(*line);
    if (std::optional<GrblStatus> status = ParseGrblStatus(*line, grbl_.axis)) return *status;
  }
  return Silent();
}

/// A controller that was just plugged in sends its greeting first, and may be locked until it is homed or unlocked.
Status GrblTurntable::Unlock() {
  line_->Discard();
  Result<GrblStatus> status = Query();
  if (!status.ok() && status.status().code() == "table_alarm") status = Query();
  if (!status.ok()) return status.status();
  if (status->state == "Run" || status->state == "Jog" || status->state == "Hold") DRUPE_RETURN_IF_ERROR(Stop());
  return options_.home ? Status::Ok() : Command("$X", kReplyPatience);
}

Status GrblTurntable::Prepare() {
  DRUPE_RETURN_IF_ERROR(Unlock());
  if (options_.home) DRUPE_RETURN_IF_ERROR(Command("$H", kHomingPatience));
  DRUPE_RETURN_IF_ERROR(WaitForRest(nullptr, kHomingPatience));
  DRUPE_ASSIGN_OR_RETURN(const GrblStatus status, Query());
  origin_ = status.position;
  return Status::Ok();
}

Status GrblTurntable::WaitForRest(const Cancelled& cancelled, milliseconds patience) {
  const auto deadline = SteadyClock::now() + patience;
  while (SteadyClock::now() < deadline) {
    DRUPE_ASSIGN_OR_RETURN(const GrblStatus status, Query());
    if (status.state == "Alarm") return Alarm("an alarm");
    if (status.state == "Idle") return Status::Ok();
    if (cancelled && cancelled()) {
      DRUPE_RETURN_IF_ERROR(Stop());
      return drupe::Cancelled();
    }
    std::this_thread::sleep_for(kPoll);
  }
  return Silent();
}

Status GrblTurntable::StartTurn(double angle_deg, double speed_deg_s) {
  DRUPE_ASSIGN_OR_RETURN(const GrblStatus status, Query());
  if (status.state == "Alarm") return Alarm("an alarm");
  const double distance = origin_ + Direction() * angle_deg - status.position;
  if (std::abs(distance) < kSmallestMoveDeg) return Status::Ok();
  char command[80];
  std::snprintf(command, sizeof(command), "G91 G1 %c%.3f F%.3f", grbl_.axis, distance, speed_deg_s * 60);
  return Command(command, kReplyPatience);
}

Status GrblTurntable::MoveTo(double angle_deg, const Cancelled& cancelled) {
  DRUPE_ASSIGN_OR_RETURN(const TableReading start, Read());
  DRUPE_RETURN_IF_ERROR(StartTurn(angle_deg, options_.speed_deg_s));
  const double seconds = std::abs(angle_deg - start.angle_deg) / options_.speed_deg_s;
  DRUPE_RETURN_IF_ERROR(WaitForRest(cancelled, milliseconds(static_cast<int>(2'000 * seconds)) + 5 * kReplyPatience));
  std::this_thread::sleep_for(milliseconds(options_.settle_ms));
  return Status::Ok();
}

/// An answer that took long does not say when the table stood there: it is asked again, a few times.
Result<TableReading> GrblTurntable::Read() {
  TableReading reading;
  SteadyClock::duration least = SteadyClock::duration::max();
  for (int i = 0; i < kReadings && least > 2 * quickest_ + kUsualDelay; ++i) {
    const auto asked = SteadyClock::now();
    DRUPE_ASSIGN_OR_RETURN(const GrblStatus status, Query());
    if (status.state == "Alarm") return Alarm("an alarm");
    const SteadyClock::duration took = SteadyClock::now() - asked;
    quickest_ = std::min(quickest_, took);
    if (took >= least) continue;
    least = took;
    reading = {Direction() * (status.position - origin_), status.state != "Idle", asked + took / 2};
  }
  return reading;
}

/// Feed hold, and once at rest a reset, which then keeps the position and drops the rest of the move.
Status GrblTurntable::Stop() {
  DRUPE_RETURN_IF_ERROR(line_->Write("!"));
  const auto deadline = SteadyClock::now() + 2 * kReplyPatience;
  while (SteadyClock::now() < deadline) {
    DRUPE_ASSIGN_OR_RETURN(const GrblStatus status, Query());
    if (status.state != "Run" && status.state != "Jog") break;
    std::this_thread::sleep_for(kPoll);
  }
  std::this_thread::sleep_for(5 * kPoll);  // "Hold:1" becomes "Hold:0": the last steps of the slowing down
  DRUPE_RETURN_IF_ERROR(line_->Write(std::string(1, kSoftReset)));
  std::this_thread::sleep_for(5 * kPoll);
  return Command("$X", kReplyPatience);
}

void GrblTurntable::EmergencyStop() {
  const Status ignored = line_->Write(std::string("!") + kSoftReset);
  (void)ignored;  // there is nothing left to try
}

}  // namespace drupe
