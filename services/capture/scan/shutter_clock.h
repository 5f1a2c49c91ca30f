#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace drupe {

/// When frames were exposed, by our clock: the camera's own time stamp, set against our clock by the frame that took
/// the least time to come. A busy machine notes some frames tens of milliseconds late, in which the table turns on.
class ShutterClock {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// `timestamp_ns` is by the camera's clock, 0 when it gives none; `received` when the first packet came. The answer
  /// is never later than `received`.
  TimePoint ExposedAt(std::uint64_t timestamp_ns, TimePoint received);

 private:
  std::optional<std::chrono::nanoseconds> least_delay_;  ///< ours less the camera's
};

}  // namespace drupe
