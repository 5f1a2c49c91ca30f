#include "capture/scan/frame_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/files.h"
#include "capture/scan/small_picture.h"
#include "image/decode.h"

namespace drupe {
namespace {

RgbImage Sample(const std::string& name) {
  const auto bytes = ReadFile(std::string(DRUPE_TEST_DATA) + "/plum-s/images/" + name);
  auto image = bytes.ok() ? DecodeRgb(*bytes) : Result<RgbImage>(bytes.status());
  EXPECT_TRUE(image.ok());
  return image.ok() ? std::move(*image) : RgbImage(8, 8, 3);
}

RgbImage Changed(const RgbImage& image, int (*change)(int)) {
  RgbImage changed = image.Clone();
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < 3 * image.width(); ++x) {
      changed.Row(y)[x] = static_cast<std::uint8_t>(std::clamp(change(image.Row(y)[x]), 0, 255));
    }
  }
  return changed;
}

RgbImage Smeared(const RgbImage& image, int radius) {
  RgbImage smeared = image.Clone();
  for (int y = 0; y < image.height(); ++y) {
    for (int x = radius; x + radius < image.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int i = -radius; i <= radius; ++i) sum += image.At(x + i, y, c);
        smeared.At(x, y, c) = static_cast<std::uint8_t>(sum / (2 * radius + 1));
      }
    }
  }
  return smeared;
}

using Faults = std::vector<std::string>;

TEST(FrameInspectorTest, GoodFramesHaveNoFaults) {
  FrameInspector inspector({});
  for (const char* name : {"00.jpg", "01.jpg", "02.jpg", "09.jpg", "18.jpg"}) {
    const FrameCheck check = inspector.Inspect(Sample(name), 0.3, true);
    EXPECT_EQ(check.faults, Faults()) << name << ToJson(check).dump();
    EXPECT_GT(check.markers, 10);
    inspector.Remember(check);
  }
}

TEST(FrameInspectorTest, FindsEachFault) {
  const RgbImage first = Sample("00.jpg"), second = Sample("01.jpg");
  FrameInspector inspector({});
  for (const char* name : {"03.jpg", "04.jpg", "00.jpg"}) inspector.Remember(inspector.Inspect(Sample(name), 0, true));
  EXPECT_EQ(inspector.Inspect(first, 0, true).faults, Faults{"duplicate"});
  EXPECT_EQ(inspector.Inspect(first, 0, false).faults, Faults());
  EXPECT_EQ(inspector.Inspect(second, 4, true).faults, Faults{"moved"});
  const FrameCheck smeared = inspector.Inspect(Smeared(first, 4), 0, true);
  EXPECT_TRUE(std::count(smeared.faults.begin(), smeared.faults.end(), "blurred")) << ToJson(smeared).dump();
  const FrameCheck bright = inspector.Inspect(Changed(second, [](int v) { return 3 * v; }), 0, true);
  EXPECT_TRUE(std::count(bright.faults.begin(), bright.faults.end(), "saturated")) << ToJson(bright).dump();
  const FrameCheck dark = inspector.Inspect(Changed(first, [](int v) { return v / 12; }), 0, true);
  EXPECT_TRUE(std::count(dark.faults.begin(), dark.faults.end(), "dark")) << ToJson(dark).dump();
  const FrameCheck blank = inspector.Inspect(Changed(first, [](int) { return 128; }), 0, true);
  EXPECT_TRUE(std::count(blank.faults.begin(), blank.faults.end(), "no_board")) << ToJson(blank).dump();
}

TEST(FrameInspectorTest, JudgesByTheScansOwnFrames) {
  const RgbImage first = Sample("00.jpg");
  FrameInspector inspector({});
  for (const char* name : {"03.jpg", "04.jpg", "05.jpg", "00.jpg"}) {
    inspector.Remember(inspector.Inspect(Sample(name), 0, true));
  }
  // The same view again with the grain of a dark sensor: more change than a fixed limit allows for.
  RgbImage grainy = first.Clone();
  std::mt19937 random(1);
  for (int y = 0; y < grainy.height(); ++y) {
    for (int x = 0; x < 3 * grainy.width(); ++x) {
      const int noise = static_cast<int>(random() % 61) - 30;
      grainy.Row(y)[x] = static_cast<std::uint8_t>(std::clamp(grainy.Row(y)[x] + noise, 0, 255));
    }
  }
  const FrameCheck check = inspector.Inspect(grainy, 0, true);
  EXPECT_GT(check.change, FrameCheckOptions().min_change);
  EXPECT_TRUE(std::count(check.faults.begin(), check.faults.end(), "duplicate")) << ToJson(check).dump();
  // A lamp failed: brighter than a fixed limit asks for, but not than the frames before.
  const FrameCheck dim = inspector.Inspect(Changed(Sample("07.jpg"), [](int v) { return v / 4; }), 0, true);
  EXPECT_GT(dim.bright_level, FrameCheckOptions().min_bright_level);
  EXPECT_TRUE(std::count(dim.faults.begin(), dim.faults.end(), "dark")) << ToJson(dim).dump();
}

TEST(FrameInspectorTest, WritesWhatItReads) {
  FrameInspector inspector({});
  const FrameCheck check = inspector.Inspect(Sample("00.jpg"), 9, true);
  EXPECT_EQ(ToJson(ParseFrameCheck(ToJson(check))), ToJson(check));
  EXPECT_TRUE(ParseFrameCheck(Json()).ok());
  EXPECT_EQ(FrameCheckOptions{.dictionary = "DICT_NONE"}.Check().field(), "board.dictionary");
}

TEST(SmallPictureTest, ShrinksAndEncodes) {
  const RgbImage image = Sample("00.jpg");
  const RgbImage small = ShrinkTo(image, 640);
  EXPECT_EQ(small.width(), image.width() / 2);
  EXPECT_EQ(small.channels(), 3);
  const auto jpeg = EncodeJpeg(small, 90);
  ASSERT_TRUE(jpeg.ok());
  const auto decoded = DecodeRgb(*jpeg);
  ASSERT_TRUE(decoded.ok());
  EXPECT_NEAR(decoded->At(100, 100, 1), small.At(100, 100, 1), 12);
}

}  // namespace
}  // namespace drupe
