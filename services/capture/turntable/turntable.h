#pragma once

#include <chrono>
#include <functional>

#include "base/status.h"

namespace drupe {

/// How a turntable is moved.
struct TurntableOptions {
  double speed_deg_s = 30;  ///< of the moves between views, 0.1..360
  int settle_ms = 300;      ///< rest between the end of a move and the shutter, 0..60000
  bool clockwise = false;   ///< seen from above: angles count in this direction
  bool home = false;        ///< seek the reference switch before a scan; else the table starts where it stands

  /// Errors: 400 `invalid_option` with the field.
  Status Check() const;
};

/// Where the table was at an instant.
struct TableReading {
  double angle_deg = 0;  ///< from the origin, in the direction of the options; not wrapped at 360
  bool moving = false;
  std::chrono::steady_clock::time_point at;
};

/// A turntable. One caller at a time, except EmergencyStop. Errors of every call: 503 `table_unreachable` (the line is
/// gone or silent), 409 `table_alarm` (the controller has locked itself: the position may be lost), 422
/// `table_refused` (it does not understand).
class Turntable {
 public:
  using Cancelled = std::function<bool()>;

  virtual ~Turntable() = default;

  /// Makes it ready to move: unlocked, at rest, homed if asked for. The present place becomes the origin, angle 0.
  virtual Status Prepare() = 0;
  /// The origin in the controller's own count, for a scan that goes on after this process has died.
  virtual double origin_deg() const = 0;
  virtual void set_origin_deg(double origin_deg) = 0;

  /// Turns to `angle_deg` and returns once it rests there and has settled. Errors: `cancelled` (then it is stopped).
  virtual Status MoveTo(double angle_deg, const Cancelled& cancelled) = 0;
  /// Begins to turn to `angle_deg` at `speed_deg_s` and returns at once.
  virtual Status StartTurn(double angle_deg, double speed_deg_s) = 0;
  virtual Result<TableReading> Read() = 0;
  /// Comes to rest without losing the position.
  virtual Status Stop() = 0;
  /// Stops whatever it costs, position included. From any thread.
  virtual void EmergencyStop() = 0;
  /// False for a table that turns by itself: it cannot be sent to an angle.
  virtual bool can_position() const { return true; }
};

}  // namespace drupe
