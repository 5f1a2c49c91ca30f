#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "capture/simulator/simulated_rig.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

void WaitForRest(const SimulatedTable& table) {
  for (int i = 0; i < 500 && table.moving(); ++i) std::this_thread::sleep_for(milliseconds(5));
}

TEST(SimulatedTableTest, PulsesOnceAtEveryMultipleInEitherDirection) {
  std::atomic<int> pulses = 0;
  SimulatedTable table(10, [&](double) { ++pulses; });
  table.Move(360, 3600);
  WaitForRest(table);
  EXPECT_DOUBLE_EQ(table.position_deg(), 360);
  EXPECT_EQ(pulses, 36);  // leaving 0 is none, reaching 360 is one
  table.Move(-25, 3600);
  WaitForRest(table);
  EXPECT_EQ(pulses, 38);  // 350, 340
  table.SkipPulses(1);
  table.Move(15, 3600);
  WaitForRest(table);
  EXPECT_EQ(pulses, 39);  // 340 is swallowed, 350 comes
}

TEST(SimulatedTableTest, StopsWhereItIs) {
  SimulatedTable table(10, nullptr);
  table.Move(1000, 100);
  std::this_thread::sleep_for(milliseconds(30));
  table.Stop();
  const double stopped = table.position_deg();
  EXPECT_GT(stopped, 0);
  EXPECT_LT(stopped, 100);
  std::this_thread::sleep_for(milliseconds(20));
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
