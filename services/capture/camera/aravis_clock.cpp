#include "capture/camera/aravis_clock.h"

#include <arv.h>

#include "capture/camera/aravis_handles.h"

namespace drupe {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr int kReadings = 8;  // on a busy machine one of them is quick
constexpr guint64 kControl = 0x944, kLatchedHigh = 0x948, kLatchedLow = 0x94C;
constexpr guint32 kLatch = 2;

bool CompareOnce(ArvDevice* device, guint64 ticks_per_s, ShutterClock& clock) {
  AravisError error;
  const auto asked = SteadyClock::now();
  if (!arv_device_write_register(device, kControl, kLatch, error.out())) return false;
  const auto answered = SteadyClock::now();
  guint32 high = 0, low = 0;
  if (!arv_device_read_register(device, kLatchedHigh, &high, error.out())) return false;
  if (!arv_device_read_register(device, kLatchedLow, &low, error.out())) return false;
  const guint64 ticks = guint64{high} << 32 | low, second = 1'000'000'000;
  clock.Compare(ticks / ticks_per_s * second + ticks % ticks_per_s * second / ticks_per_s, asked, answered);
  return true;
}

}  // namespace

void CompareClocks(ArvCamera* camera, ShutterClock& clock) {
  ArvDevice* device = arv_camera_get_device(camera);
  if (!ARV_IS_GV_DEVICE(device)) return;
  AravisError error;
  const guint64 ticks_per_s = arv_gv_device_get_timestamp_tick_frequency(ARV_GV_DEVICE(device), error.out());
  if (ticks_per_s == 0) return;
  for (int i = 0; i < kReadings && CompareOnce(device, ticks_per_s, clock); ++i) continue;
}

}  // namespace drupe
