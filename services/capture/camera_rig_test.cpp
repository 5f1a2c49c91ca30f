#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "capture/camera/steady_camera.h"
#include "capture/simulator/rig_fixture.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

constexpr std::chrono::seconds kPatience{30};
constexpr int kTries = 20;

/// The frame of `trigger`, which is pulled again when the end of a frame was lost: on a busy machine the socket runs
/// over, and nobody asks for packets that no later one shows to be missing.
template <typename Trigger>
Result<RawFrame> Take(Camera& camera, const Trigger& trigger) {
  Status lost;
  for (int i = 0; i < kTries; ++i) {
    trigger();
    Result<RawFrame> frame = camera.NextFrame(kPatience);
    if (frame.status().code() != "frame_incomplete") return frame;
    lost = frame.status();
  }
  return lost;
}

Result<RawFrame> Fire(Camera& camera) {
  return Take(camera, [&] { EXPECT_TRUE(camera.FireTrigger().ok()); });
}

/// Whether one trigger gives one frame, which develops; false when its end was lost, see Take.
bool OneTriggerGivesOneFrame(const SimulatedRig& rig) {
  auto camera = Camera::Open(rig.camera_id(), {});
  EXPECT_TRUE(camera.ok()) << camera.status().ToString();
  if (!camera.ok() || !(*camera)->Start().ok() || !(*camera)->FireTrigger().ok()) return false;
  EXPECT_EQ((*camera)->width(), rig.pictures().width());
  EXPECT_EQ((*camera)->identity().serial, "RIG1");
  const auto frame = (*camera)->NextFrame(kPatience);
  if (!frame.ok()) return false;
  EXPECT_GE(static_cast<int>(frame->layout), static_cast<int>(FrameLayout::kBayerGr));
  EXPECT_TRUE(DevelopFrame(*frame).ok());
  EXPECT_EQ((*camera)->NextFrame(milliseconds(150)).status().code(), "frame_timeout");
  EXPECT_EQ((*camera)->counters().frames, 1);
  EXPECT_EQ((*camera)->counters().timeouts, 1);
  return true;
}

TEST(CameraRigTest, TakesABayerFrameThatDevelopsIntoThePicture) {
  const auto rig = StartRig();
  bool taken = false;
  for (int i = 0; i < kTries && !taken; ++i) taken = OneTriggerGivesOneFrame(*rig);
  EXPECT_TRUE(taken);
}

TEST(CameraRigTest, TakesARegionInColourAndInGrey) {
  const auto rig = StartRig();
  for (const auto format : {CameraPixelFormat::kRgb8, CameraPixelFormat::kMono8}) {
    CameraOptions options;
    options.region = {64, 32, 320, 200}, options.pixel_format = format;
    options.exposure_us = 4000, options.gain = 2;
    auto camera = Camera::Open(rig->camera_id(), options);
    ASSERT_TRUE(camera.ok()) << camera.status().ToString();
    ASSERT_TRUE((*camera)->Start().ok());
    const auto frame = Fire(**camera);
    ASSERT_TRUE(frame.ok()) << frame.status().ToString();
    EXPECT_EQ(frame->width, 320);
    EXPECT_EQ(frame->height, 200);
    EXPECT_EQ(frame->layout == FrameLayout::kRgb, format == CameraPixelFormat::kRgb8);
  }
}

TEST(CameraRigTest, TheTriggerLineMakesFramesAndTheCameraRunsFreeWithoutTrigger) {
  const auto rig = StartRig();
  for (const auto trigger : {CameraTrigger::kLine, CameraTrigger::kFree}) {
    CameraOptions options;
    options.trigger = trigger;
    options.frame_rate = 20;
    auto camera = Camera::Open(rig->camera_id(), options);
    ASSERT_TRUE(camera.ok()) << camera.status().ToString();
    ASSERT_TRUE((*camera)->Start().ok());
    std::chrono::steady_clock::time_point pulse;
    const auto frame = Take(**camera, [&] {
      pulse = std::chrono::steady_clock::now() - milliseconds(400);  // the camera is late with it
      if (trigger == CameraTrigger::kLine) rig->camera().PulseLine(0, pulse);
    });
    ASSERT_TRUE(frame.ok()) << frame.status().ToString();
    const auto late = std::chrono::duration_cast<milliseconds>(frame->exposed - pulse);
    EXPECT_TRUE(trigger == CameraTrigger::kFree || std::abs(late.count()) < 100) << late.count();
  }
}

/// Whether five frames come whole though packets are lost.
bool FiveFramesComeWhole() {
  const auto rig = StartRig({.loss = 0.02});
  auto camera = Camera::Open(rig->camera_id(), {});
  EXPECT_TRUE(camera.ok()) << camera.status().ToString();
  if (!camera.ok() || !(*camera)->Start().ok()) return false;
  for (int i = 0; i < 5; ++i) {
    const auto frame = Fire(**camera);
    EXPECT_TRUE(frame.ok()) << frame.status().ToString();
  }
  EXPECT_GT((*camera)->counters().resent_packets, 0);
  return (*camera)->counters().incomplete_frames == 0;
}

TEST(CameraRigTest, LostPacketsAreAskedForAgain) {
  bool whole = false;  // unless the machine is so busy that the socket runs over: that is no network's loss
  for (int i = 0; i < kTries && !whole; ++i) whole = FiveFramesComeWhole();
  EXPECT_TRUE(whole);
}

TEST(CameraRigTest, WithoutResendAFrameIsIncompleteAndSaysSo) {
  const auto rig = StartRig({.loss = 0.02});
  CameraOptions options;
  options.resend = false, options.frame_timeout_ms = 1000;  // longer than a busy machine lets the camera pause
  auto camera = Camera::Open(rig->camera_id(), options);
  ASSERT_TRUE(camera.ok()) << camera.status().ToString();
  ASSERT_TRUE((*camera)->Start().ok() && (*camera)->FireTrigger().ok());
  EXPECT_EQ((*camera)->NextFrame(kPatience).status().code(), "frame_incomplete");
  EXPECT_EQ((*camera)->counters().incomplete_frames, 1);
}

TEST(CameraRigTest, AnAbsentCameraIsNotFound) {
  EXPECT_EQ(Camera::Open("Aravis-Fake-NOBODY", {}).status().code(), "camera_not_found");
}

TEST(SteadyCameraTest, ComesBackAfterItWasUnplugged) {
  const auto rig = StartRig();
  SteadyCamera camera(rig->camera_id(), {}, {.patience = std::chrono::seconds(20)}, nullptr);
  ASSERT_TRUE(camera.ShootPatiently(kTries).ok());
  rig->camera().Unplug();
  EXPECT_EQ(camera.Shoot(milliseconds(500)).status().code(), "camera_lost");
  ASSERT_TRUE(rig->camera().Plug().ok());
  const auto frame = camera.ShootPatiently(kTries);
  EXPECT_TRUE(frame.ok()) << frame.status().ToString();
  EXPECT_EQ(camera.counters().reconnects, 1);
}

TEST(SteadyCameraTest, DoesNotWaitForEver) {
  SteadyCamera camera("Aravis-Fake-NOBODY", {}, {.patience = milliseconds(10)}, nullptr);
  EXPECT_EQ(camera.Ensure().code(), "camera_away");
  SteadyCamera cancelled("Aravis-Fake-NOBODY", {}, {}, [] { return true; });
  EXPECT_EQ(cancelled.Ensure().kind(), StatusKind::kCancelled);
}

}  // namespace
}  // namespace drupe
