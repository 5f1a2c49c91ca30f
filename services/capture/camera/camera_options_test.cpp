#include "capture/camera/camera_options.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

TEST(CameraOptionsTest, KeepsWhatItWrites) {
  const Json json = {{"pixel_format", "rgb8"}, {"exposure_us", 2500.0}, {"region", {{"x", 8}, {"width", 640}}}};
  const auto options = ParseCameraOptions(json);
  ASSERT_TRUE(options.ok()) << options.status().ToString();
  EXPECT_EQ(options->pixel_format, CameraPixelFormat::kRgb8);
  EXPECT_EQ(options->region.width, 640);
  EXPECT_FALSE(options->gain);
  const auto again = ParseCameraOptions(ToJson(*options));
  ASSERT_TRUE(again.ok()) << again.status().ToString();
  EXPECT_EQ(ToJson(*again), ToJson(*options));
}

TEST(CameraOptionsTest, NamesWhatIsWrong) {
  const auto field = [](const Json& json) { return ParseCameraOptions(json).status().field(); };
  EXPECT_EQ(field({{"pixel_format", "yuv"}}), "camera.pixel_format");
  EXPECT_EQ(field({{"exposure_us", 0}}), "camera.exposure_us");
  EXPECT_EQ(field({{"buffers", 1}}), "camera.buffers");
  EXPECT_EQ(field({{"packet_bytes", 100}}), "camera.packet_bytes");
  EXPECT_EQ(field({{"trigger_line", "Line 1; reboot"}}), "camera.trigger_line");
  EXPECT_EQ(field({{"region", {{"z", 1}}}}), "camera.region.z");
  EXPECT_EQ(field({{"shutter", 1}}), "camera.shutter");
}

TEST(CameraChoiceTest, IsAnIdOrOptionsWithOne) {
  EXPECT_EQ(ParseCameraChoice("Maker-1")->id, "Maker-1");
  EXPECT_EQ(ParseCameraChoice(Json())->id, "");
  const auto choice = ParseCameraChoice({{"id", "Maker-2"}, {"gain", 3}});
  ASSERT_TRUE(choice.ok()) << choice.status().ToString();
  EXPECT_EQ(choice->options.gain, 3);
  EXPECT_EQ(ToJson(*ParseCameraChoice(ToJson(*choice))), ToJson(*choice));
  for (const Json& bad : {Json(3), Json(std::string(129, 'x')), Json::array()}) {
    EXPECT_EQ(ParseCameraChoice(bad).status().field(), "camera") << bad;
  }
  EXPECT_EQ(ParseCameraChoice({{"id", 3}}).status().field(), "camera.id");
}

}  // namespace
}  // namespace drupe
