#include "defect_analysis/models/labelled_colours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "defect_analysis/models/colour_sample.h"

namespace drupe {
namespace {

TEST(LabelBySurface, LeavesOutWhatIsNear) {
  PointCloud cloud;
  cloud.positions = {{0, 0, 0.2f}, {0, 0, 0.6f}, {0, 0, 1.5f}, {100, 0, 0}, {-0.9f, 0, -0.9f}};
  cloud.colours.assign(5, Rgb8(1, 2, 3));
  cloud.colours[2] = Rgb8(9, 9, 9);
  const LabelledColours labelled = LabelBySurface(cloud, {{0, 0, 0}, {0.1f, 0, 0}});
  EXPECT_EQ(labelled.is_fruit, (std::vector<std::uint8_t>{1, 0, 0, 0}));
  EXPECT_EQ(labelled.colours[1], Rgb8(9, 9, 9));
}

std::string LabelledPly(const std::string& last_property, char label) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n" +
      last_property + "end_header\n";
  const std::string place(12, '\0');
  return ply + place + "\x10\x20\x30" + label + place + "\x40\x50\x60" + '\1';
}

TEST(ReadLabelledPly, TakesZeroAndOne) {
  const auto read = ReadLabelledPly(LabelledPly("property uchar label\n", '\0'));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->is_fruit, (std::vector<std::uint8_t>{0, 1}));
  EXPECT_EQ(read->colours[1], Rgb8(0x40, 0x50, 0x60));
  EXPECT_EQ(ReadLabelledPly(LabelledPly("property uchar label\n", '\7'))->size(), 1u);
  EXPECT_EQ(ReadLabelledPly(LabelledPly("property uchar class\n", '\0')).status().code(), "no_labels");
  EXPECT_EQ(ReadLabelledPly("ply\n").status().code(), "bad_ply");
}

TEST(ReadMaskedImage, RefusesWhatIsNoPicture) {
  EXPECT_EQ(ReadMaskedImage("no picture", "no mask").status().code(), "unsupported_image");
}

TEST(SampleColours, KeepsRareColours) {
  LabelledColours all;
  for (int k = 0; k < 100000; ++k) all.Add(Rgb8(250, 250, 250), false);
  for (int k = 0; k < 40; ++k) all.Add(Rgb8(90, 90, 95), false);
  for (int k = 0; k < 30; ++k) all.Add(Rgb8(20, 200, 20), true);
  const LabelledColours sample = SampleColours(all, 500);
  const auto count = [&](const Rgb8& colour) {
    return std::count(sample.colours.begin(), sample.colours.end(), colour);
  };
  EXPECT_GE(count(Rgb8(90, 90, 95)), 9);
  EXPECT_LE(sample.size(), 530u);
  EXPECT_EQ(count(Rgb8(20, 200, 20)), 30);
}

TEST(Recolour, TurnsAroundTheGreyAxis) {
  EXPECT_EQ(Recolour(Rgb8(80, 80, 80), 77, 1), Rgb8(80, 80, 80));
  EXPECT_EQ(Recolour(Rgb8(40, 160, 80), 120, 1), Rgb8(80, 40, 160));
  EXPECT_EQ(Recolour(Rgb8(40, 160, 80), 0, 0.5), Rgb8(20, 80, 40));
}

TEST(SplitOff, KeepsTheSharesOfBothClasses) {
  LabelledColours kept, split;
  for (int k = 0; k < 100; ++k) kept.Add(Rgb8(1, 1, 1), k < 20);
  SplitOff(0.25, kept, split);
  EXPECT_EQ(split.size(), 25u);
  EXPECT_EQ(std::count(split.is_fruit.begin(), split.is_fruit.end(), 1), 5);
  EXPECT_EQ(kept.size(), 75u);
}

}  // namespace
}  // namespace drupe
