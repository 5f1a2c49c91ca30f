#include "capture/scan/angle_track.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

using std::chrono::milliseconds;

TEST(AngleTrackTest, InterpolatesBetweenReports) {
  AngleTrack track(12);
  const auto start = AngleTrack::TimePoint() + std::chrono::hours(1);
  EXPECT_FALSE(track.AngleAt(start));
  track.Add(start, 10, true);
  track.Add(start + milliseconds(100), 11.2, true);
  track.Add(start + milliseconds(200), 12.4, true);
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(50)), 10.6, 1e-9);
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(175)), 12.1, 1e-9);
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(300)), 13.6, 1e-9);
  EXPECT_NEAR(*track.AngleAt(start - milliseconds(100)), 8.8, 1e-9);
  EXPECT_FALSE(track.AngleAt(start + milliseconds(900)));
}

TEST(AngleTrackTest, TurnsEvenlyBetweenARestAndAReport) {
  AngleTrack track(20);
  const auto start = AngleTrack::TimePoint() + std::chrono::hours(1);
  track.Add(start, 10, false);
  track.Add(start + milliseconds(300), 14, true);  // it began 100 ms later
  track.Add(start + milliseconds(400), 16.4, true);
  track.Add(start + milliseconds(1000), 20, false);  // it ended after another 180 ms
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(50)), 10, 1e-9);
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(200)), 12, 1e-9);
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(350)), 15.2, 1e-9);  // as reported, whatever it was told
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(500)), 18.4, 1e-9);
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(800)), 20, 1e-9);
  EXPECT_NEAR(*track.AngleAt(start + milliseconds(1400)), 20, 1e-9);
}

TEST(NearestViewTest, WrapsEitherWay) {
  EXPECT_EQ(NearestView(0, 36).view, 0);
  EXPECT_EQ(NearestView(354, 36).view, 35);
  EXPECT_EQ(NearestView(356, 36).view, 0);
  EXPECT_EQ(NearestView(-11, 36).view, 35);
  EXPECT_EQ(NearestView(730, 36).view, 1);
  EXPECT_NEAR(NearestView(-11, 36).error_deg, -1, 1e-9);
  EXPECT_EQ(NearestView(119, 3).view, 1);
}

}  // namespace
}  // namespace drupe
