#include "capture/scan_request.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

TEST(ScanRequestTest, EverythingIsOptionalAndSurvivesThePayload) {
  const auto plain = ParseScanRequest(Json::object());
  ASSERT_TRUE(plain.ok()) << plain.status().ToString();
  EXPECT_EQ(plain->views, 36);
  EXPECT_EQ(plain->mode, ScanMode::kStep);
  EXPECT_EQ(plain->camera.trigger, CameraTrigger::kSoftware);
  const Json asked = {{"camera", {{"id", "Basler-1"}, {"exposure_us", 5000}}},
                      {"turntable", {{"driver", "grbl"}, {"speed_deg_s", 20}, {"home", true}}},
                      {"views", 72},
                      {"mode", "continuous"},
                      {"board", nullptr},
                      {"reconstruct", false}};
  const auto request = ParseScanRequest(asked);
  ASSERT_TRUE(request.ok()) << request.status().ToString();
  EXPECT_EQ(request->camera_id, "Basler-1");
  EXPECT_EQ(request->camera.trigger, CameraTrigger::kLine);
  EXPECT_TRUE(request->checks.dictionary.empty());
  const auto again = ParseScanRequest(ToJson(*request));
  ASSERT_TRUE(again.ok()) << again.status().ToString();
  EXPECT_EQ(ToJson(*again), ToJson(*request));
}

TEST(ScanRequestTest, ATableThatTurnsByItselfIsScannedContinuously) {
  EXPECT_EQ(ParseScanRequest({{"turntable", "external"}})->mode, ScanMode::kContinuous);
  EXPECT_EQ(ParseScanRequest({{"turntable", "external"}, {"mode", "step"}}).status().field(), "mode");
}

TEST(ScanRequestTest, NamesWhatIsWrong) {
  const auto field = [](const Json& json) { return ParseScanRequest(json).status().field(); };
  EXPECT_EQ(field({{"views", 2}}), "views");
  EXPECT_EQ(field({{"mode", "spiral"}}), "mode");
  EXPECT_EQ(field({{"turn_s", 1}}), "turn_s");
  EXPECT_EQ(field({{"turntable", "by hand"}}), "turntable.driver");
  EXPECT_EQ(field({{"turntable", {{"device", "/etc/passwd"}}}}), "turntable.device");
  EXPECT_EQ(field({{"checks", {{"min_markers", -1}}}}), "checks.min_markers");
  EXPECT_EQ(field({{"speed", 2}}), "speed");
  EXPECT_EQ(field({{"board", "mine"}}), "board");
  EXPECT_EQ(ParseScanRequest(Json::array()).status().code(), "invalid_request");
  EXPECT_EQ(ParseScanRequest({{"calibration", {{"width", 1}}}}).status().code(), "invalid_calibration");
}

}  // namespace
}  // namespace drupe
