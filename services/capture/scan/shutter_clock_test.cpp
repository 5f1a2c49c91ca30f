#include "capture/scan/shutter_clock.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

using std::chrono::milliseconds;

TEST(ShutterClockTest, TakesDelaysOffByTheCamerasClock) {
  ShutterClock clock;
  const ShutterClock::TimePoint start(std::chrono::hours(1));
  const auto stamp = [](int ms) { return std::uint64_t{1'000'000} * static_cast<std::uint64_t>(5'000 + ms); };
  EXPECT_EQ(clock.ExposedAt(stamp(0), start + milliseconds(9)), start + milliseconds(9));  // nothing to compare with
  EXPECT_EQ(clock.ExposedAt(stamp(100), start + milliseconds(102)), start + milliseconds(102));
  EXPECT_EQ(clock.ExposedAt(stamp(200), start + milliseconds(270)), start + milliseconds(202));
  EXPECT_EQ(clock.ExposedAt(0, start + milliseconds(300)), start + milliseconds(300));  // without a stamp
}

TEST(ShutterClockTest, BeginsAnewWithACameraThatWasSwitchedOff) {
  ShutterClock clock;
  const ShutterClock::TimePoint start(std::chrono::hours(1));
  clock.ExposedAt(std::uint64_t{900'000'000'000}, start);
  const auto later = start + std::chrono::seconds(10);
  EXPECT_EQ(clock.ExposedAt(std::uint64_t{1'000'000}, later), later);
  EXPECT_EQ(clock.ExposedAt(std::uint64_t{101'000'000}, later + milliseconds(140)), later + milliseconds(100));
}

}  // namespace
}  // namespace drupe
