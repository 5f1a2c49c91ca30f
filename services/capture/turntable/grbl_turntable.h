#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "capture/turntable/serial_line.h"
#include "capture/turntable/turntable.h"

namespace drupe {

/// Where a GRBL controller is found and which of its axes turns the table.
struct GrblOptions {
  std::string device = "/dev/ttyUSB0";
  int baud = 115200;
  char axis = 'A';  ///< X, Y, Z, A, B or C; one unit is one degree

  Status Check() const;
};

/// What a status report says: "<Idle|MPos:0.000,0.000,0.000,10.000|FS:0,0>".
struct GrblStatus {
  std::string state;    ///< "Idle", "Run", "Hold", "Jog", "Home", "Alarm", ... without its number
  double position = 0;  ///< of the axis, in the controller's count
};

/// Reads a status report; WPos is turned into MPos by the offset WCO, when the report has one. Nothing for any other
/// line or an axis that it does not have.
std::optional<GrblStatus> ParseGrblStatus(std::string_view line, char axis);

/// A table on a controller that speaks GRBL 1.1's G-code over a serial line: `$X`, `$H`, `G91 G1 A10 F1800`, `?`, `!`,
/// Ctrl-X. Every move is computed from the reported position, so that errors never add up.
class GrblTurntable : public Turntable {
 public:
  /// Opens the line; nothing moves yet.
  static Result<std::unique_ptr<GrblTurntable>> Open(const GrblOptions& grbl, const TurntableOptions& options);

  Status Prepare() override;
  double origin_deg() const override { return origin_; }
  void set_origin_deg(double origin_deg) override { origin_ = origin_deg; }
  Status MoveTo(double angle_deg, const Cancelled& cancelled) override;
  Status StartTurn(double angle_deg, double speed_deg_s) override;
  Result<TableReading> Read() override;
  Status Stop() override;
  void EmergencyStop() override;

 private:
  GrblTurntable(std::unique_ptr<SerialLine> line, const GrblOptions& grbl, const TurntableOptions& options)
      : line_(std::move(line)), grbl_(grbl), options_(options) {}

  double Direction() const { return options_.clockwise ? -1 : 1; }
  /// Sends a command and waits for its "ok".
  Status Command(const std::string& command, std::chrono::milliseconds patience);
  Result<GrblStatus> Query();
  Status Unlock();
  Status WaitForRest(const Cancelled& cancelled, std::chrono::milliseconds patience);

  const std::unique_ptr<SerialLine> line_;
  const GrblOptions grbl_;
  const TurntableOptions options_;
  std::mutex mutex_;  ///< one conversation at a time
  double origin_ = 0;
  std::chrono::steady_clock::duration quickest_ = std::chrono::minutes(1);  ///< answer to Read so far
};

}  // namespace drupe
