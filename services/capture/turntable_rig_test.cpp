#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "capture/simulator/grbl_emulator.h"
#include "capture/turntable/grbl_turntable.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

/// The driver against the emulated controller.
class GrblTurntableTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto emulator = GrblEmulator::Start(table_);
    ASSERT_TRUE(emulator.ok());
    emulator_ = std::move(*emulator);
  }
  std::unique_ptr<GrblTurntable> Open(TurntableOptions options = {.speed_deg_s = 300, .settle_ms = 1}) {
    auto driver = GrblTurntable::Open({.device = emulator_->device()}, options);
    EXPECT_TRUE(driver.ok()) << driver.status().ToString();
    return driver.ok() ? std::move(*driver) : nullptr;
  }

  SimulatedTable table_{10, nullptr};
  std::unique_ptr<GrblEmulator> emulator_;
};

TEST_F(GrblTurntableTest, MovesToAnglesAndBack) {
  const auto driver = Open();
  ASSERT_TRUE(driver->Prepare().ok());
  for (const double angle : {10.0, 20.0, 355.5, 0.0, -30.0}) {
    const Status moved = driver->MoveTo(angle, nullptr);
    ASSERT_TRUE(moved.ok()) << moved.ToString();
    EXPECT_NEAR(driver->Read()->angle_deg, angle, 1e-3);
    EXPECT_NEAR(table_.position_deg(), angle, 1e-3);
  }
}

TEST_F(GrblTurntableTest, CountsFromWhereItStoodAndInItsDirection) {
  table_.Move(33, 1000);
  std::this_thread::sleep_for(milliseconds(80));
  const auto driver = Open({.speed_deg_s = 300, .settle_ms = 1, .clockwise = true});
  ASSERT_TRUE(driver->Prepare().ok());
  EXPECT_NEAR(driver->origin_deg(), 33, 1e-3);
  ASSERT_TRUE(driver->MoveTo(20, nullptr).ok());
  EXPECT_NEAR(table_.position_deg(), 13, 1e-3);
  driver->set_origin_deg(0);
  EXPECT_NEAR(driver->Read()->angle_deg, -13, 1e-3);
}

TEST_F(GrblTurntableTest, AsksAgainWhenAnAnswerIsLate) {
  const auto driver = Open();
  ASSERT_TRUE(driver->Prepare().ok());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(driver->Read().ok());  // one of them is quick, however busy the machine
  ASSERT_TRUE(driver->StartTurn(300, 50).ok());
  const int before = emulator_->reports();
  emulator_->DelayReport(milliseconds(700));
  const auto asked = std::chrono::steady_clock::now();
  const auto reading = driver->Read();
  ASSERT_TRUE(reading.ok()) << reading.status().ToString();
  EXPECT_GE(emulator_->reports(), before + 2);
  EXPECT_GE(reading->at, asked + milliseconds(700));  // not by the late answer
  ASSERT_TRUE(driver->Stop().ok());
}

TEST_F(GrblTurntableTest, HomesWhenAskedTo) {
  table_.Move(33, 1000);
  std::this_thread::sleep_for(milliseconds(80));
  const auto driver = Open({.speed_deg_s = 300, .settle_ms = 1, .home = true});
  ASSERT_TRUE(driver->Prepare().ok());
  EXPECT_EQ(table_.position_deg(), 0);
}

TEST_F(GrblTurntableTest, ACancelStopsItInMidMove) {
  const auto driver = Open({.speed_deg_s = 50, .settle_ms = 1});
  ASSERT_TRUE(driver->Prepare().ok());
  const Status status = driver->MoveTo(200, [&] { return table_.position_deg() > 5; });
  EXPECT_EQ(status.kind(), StatusKind::kCancelled);
  EXPECT_FALSE(table_.moving());
  EXPECT_GT(table_.position_deg(), 5);
  EXPECT_LT(table_.position_deg(), 100);
  ASSERT_TRUE(driver->MoveTo(0, nullptr).ok());  // and the position was not lost
  EXPECT_NEAR(table_.position_deg(), 0, 1e-3);
}

TEST_F(GrblTurntableTest, AnAlarmStopsEverythingUntilItIsPreparedAgain) {
  const auto driver = Open({.speed_deg_s = 50, .settle_ms = 1});
  ASSERT_TRUE(driver->Prepare().ok());
  ASSERT_TRUE(driver->StartTurn(300, 50).ok());
  emulator_->RaiseAlarm();
  EXPECT_FALSE(table_.moving());
  EXPECT_EQ(driver->Read().status().code(), "table_alarm");
  EXPECT_EQ(driver->MoveTo(10, nullptr).code(), "table_alarm");
  ASSERT_TRUE(driver->Prepare().ok());
  EXPECT_TRUE(driver->MoveTo(10, nullptr).ok());
}

TEST_F(GrblTurntableTest, AnEmergencyStopLosesThePosition) {
  const auto driver = Open({.speed_deg_s = 50, .settle_ms = 1});
  ASSERT_TRUE(driver->Prepare().ok());
  ASSERT_TRUE(driver->StartTurn(300, 50).ok());
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_TRUE(table_.moving());
  driver->EmergencyStop();
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_FALSE(table_.moving());
  EXPECT_LT(table_.position_deg(), 300);
}

TEST_F(GrblTurntableTest, ASilentControllerIsUnreachable) {
  const auto driver = Open();
  emulator_->set_silent(true);
  EXPECT_EQ(driver->Prepare().code(), "table_unreachable");
}

TEST_F(GrblTurntableTest, OneProgramHoldsTheLine) {
  const auto driver = Open();
  if (geteuid() == 0) GTEST_SKIP() << "the system lets root open an exclusive terminal";
  EXPECT_EQ(GrblTurntable::Open({.device = emulator_->device()}, {}).status().code(), "table_unreachable");
}

}  // namespace
}  // namespace drupe
