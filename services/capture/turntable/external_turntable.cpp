#include "capture/turntable/external_turntable.h"

namespace drupe {

Status ExternalTurntable::Prepare() {
  speed_deg_s_ = 0;
  return Status::Ok();
}

Status ExternalTurntable::MoveTo(double, const Cancelled&) {
  return Unprocessable("table_refused", "a table that turns by itself cannot be sent to an angle; scan continuously");
}

Status ExternalTurntable::StartTurn(double, double speed_deg_s) {
  if (speed_deg_s_ == 0) start_ = std::chrono::steady_clock::now();
  speed_deg_s_ = speed_deg_s;
  return Status::Ok();
}

Result<TableReading> ExternalTurntable::Read() {
  const auto now = std::chrono::steady_clock::now();
  const double seconds = std::chrono::duration<double>(now - start_).count();
  return TableReading{speed_deg_s_ == 0 ? 0 : seconds * speed_deg_s_, speed_deg_s_ != 0, now};
}

}  // namespace drupe
