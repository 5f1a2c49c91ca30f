#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace drupe {

/// When frames were exposed, by our clock: the camera's own time stamp, set against our clock by reading both at once,
/// or else by the frame that took the least time to come. A busy machine notes some frames tens of milliseconds late,
/// in which the table turns on. For one connection: a camera that comes back may count from anew.
class ShutterClock {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// The camera's clock showed `timestamp_ns` at an instant between `asked` and `answered`. Of several such readings
  /// the quickest counts.
  void Compare(std::uint64_t timestamp_ns, TimePoint asked, TimePoint answered);

  /// `timestamp_ns` is by the camera's clock, 0 when it gives none; `received` when the first packet came. The answer
  /// is never later than `received`.
  TimePoint ExposedAt(std::uint64_t timestamp_ns, TimePoint received);

 private:
  std::optional<std::chrono::nanoseconds> ahead_;  ///< ours less the camera's
  std::optional<TimePoint::duration> quickest_;    ///< of the readings
};

}  // namespace drupe
