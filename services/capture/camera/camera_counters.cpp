#include "capture/camera/camera.h"

namespace drupe {

CameraCounters& CameraCounters::operator+=(const CameraCounters& other) {
  frames += other.frames;
  incomplete_frames += other.incomplete_frames;
  dropped_frames += other.dropped_frames;
  resent_packets += other.resent_packets;
  missing_packets += other.missing_packets;
  timeouts += other.timeouts;
  reconnects += other.reconnects;
  return *this;
}

Json ToJson(const CameraCounters& counters) {
  return {{"frames", counters.frames},
          {"incomplete_frames", counters.incomplete_frames},
          {"dropped_frames", counters.dropped_frames},
          {"resent_packets", counters.resent_packets},
          {"missing_packets", counters.missing_packets},
          {"timeouts", counters.timeouts},
          {"reconnects", counters.reconnects}};
}

}  // namespace drupe
