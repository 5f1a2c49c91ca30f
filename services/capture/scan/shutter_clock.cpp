#include "capture/scan/shutter_clock.h"

#include <algorithm>

namespace drupe {
namespace {

constexpr std::chrono::seconds kNewClock{2};  // no frame takes as long: the camera was switched off, or its clock set

}  // namespace

ShutterClock::TimePoint ShutterClock::ExposedAt(std::uint64_t timestamp_ns, TimePoint received) {
  if (timestamp_ns == 0) return received;
  const std::chrono::nanoseconds stamp(static_cast<std::int64_t>(timestamp_ns));
  const std::chrono::nanoseconds delay = received.time_since_epoch() - stamp;
  if (!least_delay_ || delay > *least_delay_ + kNewClock) least_delay_ = delay;
  least_delay_ = std::min(*least_delay_, delay);
  return TimePoint(std::chrono::duration_cast<TimePoint::duration>(stamp + *least_delay_));
}

}  // namespace drupe
