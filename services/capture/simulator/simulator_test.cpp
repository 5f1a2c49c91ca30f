#include <gtest/gtest.h>

#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "capture/simulator/rig_fixture.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

TEST(SimulatedTableTest, PulsesOnceAtEveryMultipleInEitherDirection) {
  std::mutex mutex;
  std::vector<double> pulses;
  const auto seen = [&] {
    const std::lock_guard lock(mutex);
    return pulses;
  };
  SimulatedTable table(10, [&](double position, SimulatedTable::TimePoint) {
    const std::lock_guard lock(mutex);
    pulses.push_back(position);
  });
  table.Move(30, 3600);
  EXPECT_TRUE(Becomes([&] { return seen() == std::vector<double>{10, 20, 30}; }));  // leaving 0 is none, reaching 30 is
  EXPECT_DOUBLE_EQ(table.position_deg(), 30);
  table.Move(-25, 3600);
  EXPECT_TRUE(Becomes([&] { return seen() == std::vector<double>{10, 20, 30, 20, 10}; }));
  EXPECT_TRUE(Becomes([&] { return !table.moving(); }));
  table.SkipPulses(1);
  table.Move(15, 3600);  // 10 is swallowed
  EXPECT_TRUE(Becomes([&] { return seen() == std::vector<double>{10, 20, 30, 20, 10, 20}; }));
  ASSERT_TRUE(Becomes([&] { return !table.moving(); }));
  const std::size_t before = seen().size();
  table.Move(360, 3600);
  EXPECT_TRUE(Becomes([&] { return !table.moving() && seen().size() == before + 36; }));
  EXPECT_DOUBLE_EQ(table.position_deg(), 380);
}

TEST(SimulatedTableTest, PassesItsPulsesWhenTheTimeSaysSo) {
  std::mutex mutex;
  std::vector<SimulatedTable::TimePoint> passed;
  SimulatedTable table(10, [&](double, SimulatedTable::TimePoint at) {
    const std::lock_guard lock(mutex);
    passed.push_back(at);
  });
  const auto before = std::chrono::steady_clock::now();
  table.Move(95, 1000);
  const auto after = std::chrono::steady_clock::now();
  ASSERT_TRUE(Becomes([&] {
    const std::lock_guard lock(mutex);
    return passed.size() == 9;
  }));
  for (int i = 0; i < 9; ++i) {
    const auto way = milliseconds(10 * (i + 1));
    EXPECT_GE(passed[static_cast<std::size_t>(i)], before + way - std::chrono::microseconds(1));
    EXPECT_LE(passed[static_cast<std::size_t>(i)], after + way + std::chrono::microseconds(1));
  }
}

TEST(SimulatedTableTest, StopsWhereItIs) {
  SimulatedTable table(10, nullptr);
  table.Move(1000, 100);
  ASSERT_TRUE(Becomes([&] { return table.position_deg() > 0.1; }));
  table.Stop();
  const double stopped = table.position_deg();
  EXPECT_FALSE(table.moving());
  EXPECT_LT(stopped, 100);
  std::this_thread::sleep_for(milliseconds(20));  // in which it would turn by 2 degrees
  EXPECT_EQ(table.position_deg(), stopped);
}

TEST(GvspFrameTest, CutsAPictureIntoPackets) {
  GvspFrame frame;
  frame.block_id = 7;
  frame.window = {.width = 100, .height = 30, .pixel_format = kPfncMono8};
  frame.packet_bytes = 1036;  // 1000 bytes of picture
  for (int i = 0; i < 3000; ++i) frame.pixels.push_back(static_cast<std::uint8_t>(i));
  ASSERT_EQ(frame.PacketCount(), 5U);
  const std::string leader = frame.Packet(0), third = frame.Packet(3), trailer = frame.Packet(4);
  EXPECT_EQ(ReadBigEndian(leader, 2, 2), 7U);
  EXPECT_EQ(ReadBigEndian(leader, 4, 4), 0x01000000U);
  EXPECT_EQ(ReadBigEndian(leader, 24, 4), 100U);
  EXPECT_EQ(ReadBigEndian(third, 4, 4), 0x03000003U);
  EXPECT_EQ(third.size(), 1008U);
  EXPECT_EQ(static_cast<std::uint8_t>(third[8]), 2000 % 256);
  EXPECT_EQ(ReadBigEndian(trailer, 4, 4), 0x02000004U);
}

TEST(PictureTurnTest, SeesTheNearestPictureThroughTheFilter) {
  auto turn = PictureTurn::Load(std::string(DRUPE_TEST_DATA) + "/plum-s/images");
  ASSERT_TRUE(turn.ok()) << turn.status().ToString();
  ASSERT_EQ(turn->count(), 36);
  const SensorWindow colour{.width = turn->width(), .height = 2, .pixel_format = kPfncRgb8};
  SensorWindow bayer = colour;
  bayer.pixel_format = kPfncBayerRg8;
  std::vector<std::uint8_t> rgb(static_cast<std::size_t>(colour.width) * 6), raw(rgb.size() / 3), again(raw.size());
  turn->Expose(-350.2, 0, colour, rgb);
  turn->Expose(9.8, 0, bayer, raw);
  EXPECT_EQ(raw[0], rgb[0]);                                          // red
  EXPECT_EQ(raw[1], rgb[4]);                                          // green
  EXPECT_EQ(raw[colour.width + 1], rgb[3 * (colour.width + 1) + 2]);  // blue in the second row
  turn->Expose(20, 0, bayer, again);
  EXPECT_NE(raw, again);
  EXPECT_EQ(PictureTurn::Load("/no/such/place").status().code(), "file_not_found");
}

TEST(SimulatedRigTest, TakesFaultsAsText) {
  auto rig = SimulatedRig::Start(
      {.pictures = std::string(DRUPE_TEST_DATA) + "/plum-s/images", .address = "127.7.0.1", .serial = "SIMTEST"});
  ASSERT_TRUE(rig.ok()) << rig.status().ToString();
  EXPECT_TRUE((*rig)->table_device().starts_with("/dev/pts/"));
  EXPECT_TRUE((*rig)->camera().plugged());
  EXPECT_EQ(*(*rig)->Obey("unplug"), "ok");
  EXPECT_FALSE((*rig)->camera().plugged());
  EXPECT_EQ(*(*rig)->Obey("plug"), "ok");
  EXPECT_NE((*rig)->Obey("status")->find("Aravis-Fake-SIMTEST"), std::string::npos);
  EXPECT_EQ((*rig)->Obey("explode").status().code(), "unknown_command");
  EXPECT_EQ(SimulatedRig::Start({.loss = 1}).status().field(), "loss");
}

}  // namespace
}  // namespace drupe
