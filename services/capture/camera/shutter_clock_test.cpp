#include "capture/camera/shutter_clock.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

using std::chrono::milliseconds;

const ShutterClock::TimePoint kStart(std::chrono::hours(1));

/// By the camera's clock, `ms` after kStart.
std::uint64_t StampAt(int ms) {
  return std::uint64_t{1'000'000} * static_cast<std::uint64_t>(5'000 + ms);
}

TEST(ShutterClockTest, TakesDelaysOffByTheQuickestFrame) {
  ShutterClock clock;
  EXPECT_EQ(clock.ExposedAt(StampAt(0), kStart + milliseconds(9)), kStart + milliseconds(9));  // the first one
  EXPECT_EQ(clock.ExposedAt(StampAt(100), kStart + milliseconds(102)), kStart + milliseconds(102));
  EXPECT_EQ(clock.ExposedAt(StampAt(200), kStart + milliseconds(270)), kStart + milliseconds(202));
  EXPECT_EQ(clock.ExposedAt(0, kStart + milliseconds(300)), kStart + milliseconds(300));  // without a stamp
}

TEST(ShutterClockTest, PlacesTheFirstFrameByTheClocksReadTogether) {
  ShutterClock clock;
  clock.Compare(StampAt(10), kStart + milliseconds(10), kStart + milliseconds(70));  // 25 ms off at the most likely
  clock.Compare(StampAt(101), kStart + milliseconds(100), kStart + milliseconds(102));
  clock.Compare(StampAt(200), kStart + milliseconds(180), kStart + milliseconds(200));
  EXPECT_EQ(clock.ExposedAt(StampAt(500), kStart + milliseconds(590)), kStart + milliseconds(500));
  EXPECT_EQ(clock.ExposedAt(StampAt(600), kStart + milliseconds(599)), kStart + milliseconds(599));  // never later
}

}  // namespace
}  // namespace drupe
