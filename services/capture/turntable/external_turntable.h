#pragma once

#include "capture/turntable/turntable.h"

namespace drupe {

/// A table that turns by itself at a constant speed while its controller sends the camera's trigger pulses (the paper's
/// section 2.2: 30 s a turn, 1.2 Hz). Nothing can be told to it; its angle follows from the time.
class ExternalTurntable : public Turntable {
 public:
  Status Prepare() override;
  double origin_deg() const override { return 0; }
  void set_origin_deg(double) override {}
  Status MoveTo(double angle_deg, const Cancelled& cancelled) override;
  Status StartTurn(double angle_deg, double speed_deg_s) override;
  Result<TableReading> Read() override;
  Status Stop() override { return Status::Ok(); }
  void EmergencyStop() override {}
  bool can_position() const override { return false; }

 private:
  std::chrono::steady_clock::time_point start_;
  double speed_deg_s_ = 0;
};

}  // namespace drupe
