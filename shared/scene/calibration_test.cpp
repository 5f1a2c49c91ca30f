#include "scene/calibration.h"

#include <gtest/gtest.h>

#include <string>

namespace drupe {
namespace {

Calibration Good() {
  Calibration calibration;
  calibration.camera = {.width = 1280,
                        .height = 720,
                        .fx = 1886.2,
                        .fy = 1885.9,
                        .cx = 632.1,
                        .cy = 359.3,
                        .dist = {-0.058, 0.0015, 0.0001, -5e-5, 0.01}};
  calibration.rms_px = 0.21;
  return calibration;
}

std::string FieldOfError(const Json& json) {
  const auto calibration = ParseCalibration(json);
  if (calibration.ok()) return "ok";
  EXPECT_EQ(calibration.status().code(), "invalid_calibration");
  return calibration.status().field();
}

std::string FieldAfter(const char* pointer, const Json& value) {
  Json json = ToJson(Good());
  json[Json::json_pointer(pointer)] = value;
  return FieldOfError(json);
}

TEST(CalibrationTest, SurvivesJson) {
  const auto json = ParseJson(DumpJson(ToJson(Good())));
  ASSERT_TRUE(json.ok());
  const auto read = ParseCalibration(*json);
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->camera.width, 1280);
  EXPECT_EQ(read->camera.height, 720);
  EXPECT_EQ(read->camera.K(), Good().camera.K());
  EXPECT_EQ(read->camera.dist, Good().camera.dist);
  EXPECT_EQ(read->rms_px, 0.21);
}

TEST(CalibrationTest, DistortionAndErrorMayBeAbsent) {
  Json json = ToJson(Good());
  json.erase("dist");
  json.erase("rms_px");
  const auto read = ParseCalibration(json);
  ASSERT_TRUE(read.ok());
  EXPECT_FALSE(read->camera.HasDistortion());
}

TEST(CalibrationTest, NamesWhatIsWrong) {
  EXPECT_EQ(FieldOfError(Json("text")), "calibration");
  EXPECT_EQ(FieldAfter("/width", 0), "width");
  EXPECT_EQ(FieldAfter("/width", 1280.5), "width");
  EXPECT_EQ(FieldAfter("/height", 1e9), "height");
  EXPECT_EQ(FieldAfter("/height", "720"), "height");
  EXPECT_EQ(FieldAfter("/K", Json::array({1, 2})), "K");
  EXPECT_EQ(FieldAfter("/K/0/0", -1886), "K");
  EXPECT_EQ(FieldAfter("/K/0/1", 2.0), "K");
  EXPECT_EQ(FieldAfter("/K/0/2", 1300), "K");
  EXPECT_EQ(FieldAfter("/K/1/1", nullptr), "K");
  EXPECT_EQ(FieldAfter("/K/1/1", 1e300), "K");
  EXPECT_EQ(FieldAfter("/dist", Json::array({0, 0, 0, 0})), "dist");
  EXPECT_EQ(FieldAfter("/dist/0", -9), "dist");
  EXPECT_EQ(FieldAfter("/dist/4", 1e300), "dist");
  EXPECT_EQ(FieldAfter("/rms_px", -1), "rms_px");
}

TEST(CalibrationTest, RefusesAnotherPictureSize) {
  EXPECT_TRUE(CheckCalibrationSize(Good(), 1280, 720).ok());
  const Status status = CheckCalibrationSize(Good(), 1920, 1080);
  EXPECT_EQ(status.code(), "calibration_size_mismatch");
  EXPECT_EQ(status.kind(), StatusKind::kUnprocessable);
  EXPECT_NE(status.message().find("1920x1080"), std::string::npos);
}

}  // namespace
}  // namespace drupe
