#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <set>

#include "capture/scan_run.h"
#include "capture/simulator/rig_fixture.h"
#include "capture/store_fixture.h"

namespace drupe {
namespace {

/// Scans over stores in a directory of their own, without a service.
class ScanRunTest : public StoreTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(StoreTest::SetUp());
    scans_ = Open<ScanStore>();
    rig_ = StartRig();
  }

  ScanRequest Request(Json json) {
    json["camera"] = {{"id", rig_->camera_id()}};
    const auto request = ParseScanRequest(json);
    EXPECT_TRUE(request.ok()) << request.status().ToString();
    return request.ok() ? *request : ScanRequest();
  }
  ScanRequest QuickSteps(int views = 12) {
    return Request({{"views", views}, {"turntable", {{"speed_deg_s", 360}, {"settle_ms", 0}}}});
  }
  Status Scan(const ScanRequest& request) {
    const ScanTools tools{
        *objects_, *scans_, state_, {.device = rig_->table_device()}, {.patience = std::chrono::seconds(10)}, [this] {
          ++stored_;
          if (after_frame_) after_frame_(stored_);
        }};
    RunContext context;
    context.cancelled = [this] {
      if (on_look_) on_look_();
      return cancel_.load();
    };
    return ScanRun(tools, "scan_test", request, context).Run();
  }
  /// Each view once, at its angle.
  void ExpectWhole(int views, double tolerance_deg) {
    const auto frames = scans_->Frames("scan_test");
    ASSERT_TRUE(frames.ok());
    ASSERT_EQ(frames->size(), static_cast<std::size_t>(views));
    for (int i = 0; i < views; ++i) {
      const ScanFrame& frame = (*frames)[static_cast<std::size_t>(i)];
      EXPECT_EQ(frame.view, i);
      EXPECT_NEAR(std::remainder(frame.angle_deg - i * 360.0 / views, 360), 0, tolerance_deg) << i;
      EXPECT_TRUE(objects_->Contains(frame.sha256));
    }
  }

  std::unique_ptr<ScanStore> scans_;
  std::unique_ptr<SimulatedRig> rig_;
  RigState state_;
  std::atomic<bool> cancel_{false};
  int stored_ = 0;
  std::function<void(int stored)> after_frame_;
  std::function<void()> on_look_;  ///< whether the scan is cancelled
};

TEST_F(ScanRunTest, StepsThroughATurn) {
  const Status status = Scan(QuickSteps());
  ASSERT_TRUE(status.ok()) << status.ToString();
  ExpectWhole(12, 0.01);
  EXPECT_TRUE(scans_->Get("scan_test")->captured);
  EXPECT_TRUE(state_.PreviewOf("scan_test"));
  EXPECT_FALSE(state_.PreviewOf("scan_other"));
  const auto frames = scans_->Frames("scan_test");
  for (const ScanFrame& frame : *frames) EXPECT_TRUE(ParseFrameCheck(frame.check).ok()) << frame.check.dump();
}

TEST_F(ScanRunTest, RetakesABlurredFrame) {
  after_frame_ = [this](int stored) {
    if (stored == 5) rig_->BlurFrames(1);  // the one after the next trigger
  };
  ASSERT_TRUE(Scan(QuickSteps(9)).ok());
  ExpectWhole(9, 0.01);
  const auto frames = scans_->Frames("scan_test");
  EXPECT_EQ((*frames)[5].attempts, 2);
  EXPECT_TRUE(ParseFrameCheck((*frames)[5].check).ok());
}

TEST_F(ScanRunTest, GoesOnWhereItWasCancelled) {
  after_frame_ = [this](int stored) { cancel_ = stored == 4; };
  EXPECT_EQ(Scan(QuickSteps()).kind(), StatusKind::kCancelled);
  EXPECT_FALSE(rig_->table().moving());
  const auto before = scans_->Frames("scan_test");
  ASSERT_EQ(before->size(), 4U);
  cancel_ = false, after_frame_ = nullptr;
  ASSERT_TRUE(Scan(QuickSteps()).ok());
  ExpectWhole(12, 0.01);
  EXPECT_EQ((*scans_->Frames("scan_test"))[0].taken_ms, (*before)[0].taken_ms);  // not taken twice
}

TEST_F(ScanRunTest, WaitsForACameraThatIsAway) {
  after_frame_ = [this](int stored) {
    if (stored == 3) rig_->camera().Unplug();
  };
  int looks = 0;  // whether it is to go on, with the table at rest: before a shot, and while the camera is missed
  on_look_ = [&] {
    const bool is_missed = !rig_->camera().plugged() && !rig_->table().moving();
    if (is_missed && ++looks == 4) {
      EXPECT_TRUE(rig_->camera().Plug().ok());
    }
  };
  const Status status = Scan(QuickSteps(6));
  ASSERT_TRUE(status.ok()) << status.ToString();
  EXPECT_GE(looks, 4);
  ExpectWhole(6, 0.01);
}

TEST_F(ScanRunTest, AnAlarmEndsTheAttemptAndTheNextGoesOn) {
  after_frame_ = [this](int stored) {
    if (stored == 3) rig_->grbl().RaiseAlarm();
  };
  EXPECT_EQ(Scan(QuickSteps(6)).code(), "table_alarm");
  after_frame_ = nullptr;
  const Status status = Scan(QuickSteps(6));
  ASSERT_TRUE(status.ok()) << status.ToString();
  ExpectWhole(6, 0.01);
}

TEST_F(ScanRunTest, ATurnGivesEveryViewAtItsAngleThoughPulsesAreMissed) {
  after_frame_ = [this](int stored) {
    if (stored == 6) rig_->table().SkipPulses(2);
  };
  const Status status = Scan(Request({{"mode", "continuous"}, {"turn_s", 12}, {"turntable", {{"speed_deg_s", 360}}}}));
  ASSERT_TRUE(status.ok()) << status.ToString();
  ExpectWhole(36, 1.5);
  EXPECT_FALSE(rig_->table().moving());
}

TEST_F(ScanRunTest, ATableThatTurnsByItselfIsFollowedByItsPulses) {
  rig_ = StartRig({.spin = true, .spin_deg_s = 61});  // not quite the 60 that the scan is told
  const Status status = Scan(Request({{"turntable", "external"}, {"turn_s", 6}}));
  ASSERT_TRUE(status.ok()) << status.ToString();
  const auto frames = scans_->Frames("scan_test");
  ASSERT_EQ(frames->size(), 36U);
  std::set<std::string> pictures;
  for (const ScanFrame& frame : *frames) pictures.insert(frame.sha256);
  EXPECT_EQ(pictures.size(), 36U);  // of each angle one
  EXPECT_TRUE(rig_->table().moving());
}

TEST_F(ScanRunTest, RefusesACalibrationOfAnotherCamera) {
  ScanRequest request = QuickSteps();
  request.calibration = *ParseJson(
      R"({"width": 1280, "height": 720, "K": [[900, 0, 640], [0, 900, 360], [0, 0, 1]], "dist": [0, 0, 0, 0, 0]})");
  request.calibrated_for.serial = "another";
  EXPECT_EQ(Scan(request).code(), "calibration_camera_mismatch");
  request.calibrated_for = {"", "25 mm"};
  request.lens = "16 mm";
  EXPECT_EQ(Scan(request).code(), "calibration_lens_mismatch");
  EXPECT_EQ(rig_->table().position_deg(), 0);
}

TEST_F(ScanRunTest, RefusesACalibrationOfAnotherSizeBeforeAnythingMoves) {
  ScanRequest request = QuickSteps();
  request.calibration = *ParseJson(
      R"({"width": 640, "height": 480, "K": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "dist": [0, 0, 0, 0, 0]})");
  EXPECT_EQ(Scan(request).code(), "calibration_size_mismatch");
  EXPECT_EQ(rig_->table().position_deg(), 0);
}

}  // namespace
}  // namespace drupe
