#include "capture/camera/shutter_clock.h"

namespace drupe {
namespace {

std::chrono::nanoseconds Stamp(std::uint64_t timestamp_ns) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(timestamp_ns));
}

}  // namespace

void ShutterClock::Compare(std::uint64_t timestamp_ns, TimePoint asked, TimePoint answered) {
  const TimePoint::duration took = answered - asked;
  if (quickest_ && took >= *quickest_) return;
  quickest_ = took;
  ahead_ = asked.time_since_epoch() + took / 2 - Stamp(timestamp_ns);
}

ShutterClock::TimePoint ShutterClock::ExposedAt(std::uint64_t timestamp_ns, TimePoint received) {
  if (timestamp_ns == 0) return received;
  const std::chrono::nanoseconds delay = received.time_since_epoch() - Stamp(timestamp_ns);
  if (!ahead_ || delay < *ahead_) ahead_ = delay;
  return TimePoint(std::chrono::duration_cast<TimePoint::duration>(Stamp(timestamp_ns) + *ahead_));
}

}  // namespace drupe
