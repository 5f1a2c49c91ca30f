#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

#include "capture/camera/steady_camera.h"
#include "capture/simulator/rig_fixture.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

TEST(CameraRigTest, TakesABayerFrameThatDevelopsIntoThePicture) {
  const auto rig = StartRig();
  auto camera = Camera::Open(rig->camera_id(), {});
  ASSERT_TRUE(camera.ok()) << camera.status().ToString();
  EXPECT_EQ((*camera)->width(), rig->pictures().width());
  EXPECT_EQ((*camera)->identity().serial, "RIG1");
  ASSERT_TRUE((*camera)->Start().ok());
  ASSERT_TRUE((*camera)->FireTrigger().ok());
  const auto frame = (*camera)->NextFrame(milliseconds(2000));
  ASSERT_TRUE(frame.ok()) << frame.status().ToString();
  EXPECT_GE(static_cast<int>(frame->layout), static_cast<int>(FrameLayout::kBayerGr));
  EXPECT_TRUE(DevelopFrame(*frame).ok());
  EXPECT_EQ((*camera)->NextFrame(milliseconds(150)).status().code(), "frame_timeout");  // one trigger, one frame
  EXPECT_EQ((*camera)->counters().frames, 1);
  EXPECT_EQ((*camera)->counters().timeouts, 1);
}

TEST(CameraRigTest, TakesARegionInColourAndInGrey) {
  const auto rig = StartRig();
  for (const auto format : {CameraPixelFormat::kRgb8, CameraPixelFormat::kMono8}) {
    CameraOptions options;
    options.region = {64, 32, 320, 200}, options.pixel_format = format;
    options.exposure_us = 4000, options.gain = 2;
    auto camera = Camera::Open(rig->camera_id(), options);
    ASSERT_TRUE(camera.ok()) << camera.status().ToString();
    ASSERT_TRUE((*camera)->Start().ok() && (*camera)->FireTrigger().ok());
    const auto frame = (*camera)->NextFrame(milliseconds(2000));
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
    const auto pulse = std::chrono::steady_clock::now() - milliseconds(400);  // the camera is late with it
    if (trigger == CameraTrigger::kLine) rig->camera().PulseLine(0, pulse);
    const auto frame = (*camera)->NextFrame(milliseconds(2000));
    ASSERT_TRUE(frame.ok()) << frame.status().ToString();
    const auto late = std::chrono::duration_cast<milliseconds>(frame->exposed - pulse);
    EXPECT_TRUE(trigger == CameraTrigger::kFree || std::abs(late.count()) < 100) << late.count();
  }
}

TEST(CameraRigTest, LostPacketsAreAskedForAgain) {
  const auto rig = StartRig({.loss = 0.02});
  auto camera = Camera::Open(rig->camera_id(), {});
  ASSERT_TRUE(camera.ok()) << camera.status().ToString();
  ASSERT_TRUE((*camera)->Start().ok());
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE((*camera)->FireTrigger().ok());
    const auto frame = (*camera)->NextFrame(milliseconds(3000));
    ASSERT_TRUE(frame.ok()) << frame.status().ToString();
  }
  EXPECT_GT((*camera)->counters().resent_packets, 0);
  EXPECT_EQ((*camera)->counters().incomplete_frames, 0);
}

TEST(CameraRigTest, WithoutResendAFrameIsIncompleteAndSaysSo) {
  const auto rig = StartRig({.loss = 0.02});
  CameraOptions options;
  options.resend = false, options.frame_timeout_ms = 100;
  auto camera = Camera::Open(rig->camera_id(), options);
  ASSERT_TRUE(camera.ok()) << camera.status().ToString();
  ASSERT_TRUE((*camera)->Start().ok() && (*camera)->FireTrigger().ok());
  EXPECT_EQ((*camera)->NextFrame(milliseconds(2000)).status().code(), "frame_incomplete");
  EXPECT_EQ((*camera)->counters().incomplete_frames, 1);
}

TEST(CameraRigTest, AnAbsentCameraIsNotFound) {
  EXPECT_EQ(Camera::Open("Aravis-Fake-NOBODY", {}).status().code(), "camera_not_found");
}

TEST(SteadyCameraTest, ComesBackAfterItWasUnplugged) {
  const auto rig = StartRig();
  SteadyCamera camera(rig->camera_id(), {}, {.patience = std::chrono::seconds(20)}, nullptr);
  const auto first = camera.Shoot(milliseconds(2000));
  ASSERT_TRUE(first.ok()) << first.status().ToString();
  rig->camera().Unplug();
  EXPECT_EQ(camera.Shoot(milliseconds(500)).status().code(), "camera_lost");
  ASSERT_TRUE(rig->camera().Plug().ok());
  const auto frame = camera.Shoot(milliseconds(2000));
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
