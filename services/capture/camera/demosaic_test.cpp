#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/files.h"
#include "capture/camera/raw_frame.h"
#include "image/decode.h"

namespace drupe {
namespace {

constexpr FrameLayout kLayouts[] = {FrameLayout::kBayerGr, FrameLayout::kBayerRg, FrameLayout::kBayerGb,
                                    FrameLayout::kBayerBg};
const char* CellOf(FrameLayout layout) {
  switch (layout) {
    case FrameLayout::kBayerGr:
      return "GRBG";
    case FrameLayout::kBayerRg:
      return "RGGB";
    case FrameLayout::kBayerGb:
      return "GBRG";
    default:
      return "BGGR";
  }
}

RawFrame MosaicOf(const RgbImage& image, FrameLayout layout) {
  RawFrame frame;
  frame.width = image.width(), frame.height = image.height(), frame.layout = layout;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const char colour = CellOf(layout)[(y & 1) * 2 + (x & 1)];
      frame.bytes.push_back(image.At(x, y, colour == 'R' ? 0 : colour == 'G' ? 1 : 2));
    }
  }
  return frame;
}

double Psnr(const RgbImage& a, const RgbImage& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < 3 * a.width(); ++x) sum += std::pow(double(a.Row(y)[x]) - b.Row(y)[x], 2);
  }
  return 10 * std::log10(255.0 * 255.0 * 3 * a.width() * a.height() / sum);
}

TEST(DemosaicTest, KeepsAnEvenColourInEveryLayout) {
  RgbImage even(10, 8, 3);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 10; ++x) even.At(x, y, 0) = 200, even.At(x, y, 1) = 90, even.At(x, y, 2) = 30;
  }
  for (const FrameLayout layout : kLayouts) {
    const auto image = DevelopFrame(MosaicOf(even, layout));
    ASSERT_TRUE(image.ok());
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 30; ++x) EXPECT_EQ(image->Row(y)[x], even.Row(y)[x]) << x << ' ' << y;
    }
  }
}

/// The mean of the same colour's pixels in the 3 x 3 neighbourhood: the method to beat.
RgbImage Bilinear(const RawFrame& frame) {
  RgbImage image(frame.width, frame.height, 3);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      int sum[3] = {}, count[3] = {};
      for (int v = std::max(0, y - 1); v <= std::min(frame.height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(frame.width - 1, x + 1); ++u) {
          const char colour = CellOf(frame.layout)[(v & 1) * 2 + (u & 1)];
          const int channel = colour == 'R' ? 0 : colour == 'G' ? 1 : 2;
          const bool here = u == x && v == y;
          if (here) sum[channel] = count[channel] = 0;
          if (here || CellOf(frame.layout)[(y & 1) * 2 + (x & 1)] != colour) {
            sum[channel] += frame.bytes[std::size_t(v) * frame.width + u], ++count[channel];
          }
        }
      }
      for (int c = 0; c < 3; ++c) image.At(x, y, c) = static_cast<std::uint8_t>(sum[c] / count[c]);
    }
  }
  return image;
}

RgbImage Photograph(const std::string& name = "00.jpg") {
  return DecodeRgb(ReadFile(std::string(DRUPE_TEST_DATA) + "/plum-s/images/" + name).value()).value();
}

TEST(DemosaicTest, RestoresAPhotographBetterThanBilinearly) {
  const RgbImage photograph = Photograph();
  for (const FrameLayout layout : kLayouts) {
    const auto image = DevelopFrame(MosaicOf(photograph, layout));
    ASSERT_TRUE(image.ok());
    EXPECT_GT(Psnr(*image, photograph), Psnr(Bilinear(MosaicOf(photograph, layout)), photograph) + 4);
    EXPECT_GT(Psnr(*image, photograph), 35);
  }
}

double LumaPsnr(const RgbImage& a, const RgbImage& b) {
  const auto luma = [](const RgbImage& image, int x, int y) {
    return 0.299 * image.At(x, y, 0) + 0.587 * image.At(x, y, 1) + 0.114 * image.At(x, y, 2);
  };
  double sum = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) sum += std::pow(luma(a, x, y) - luma(b, x, y), 2);
  }
  return 10 * std::log10(255.0 * 255.0 * a.width() * a.height() / sum);
}

// Poses follow luma: what the mosaic adds to it must stay below the noise of a sample, which is two levels here.
TEST(DemosaicTest, RestoresLumaToLessThanALevel) {
  const RgbImage photograph = Photograph();
  for (const FrameLayout layout : kLayouts) {
    const auto image = DevelopFrame(MosaicOf(photograph, layout));
    ASSERT_TRUE(image.ok());
    EXPECT_GT(LumaPsnr(*image, photograph), 20 * std::log10(255));
    EXPECT_GT(Psnr(*image, photograph), 44);  // colour is filtered less than luma, so that small spots keep theirs
  }
}

// Rows and columns tell the same false colour of a slanted edge from black to white.
TEST(DemosaicTest, GivesNoFalseColourBackAtEdgesOfMarkers) {
  const RgbImage photograph = Photograph("05.jpg");
  for (const FrameLayout layout : kLayouts) {
    const auto image = DevelopFrame(MosaicOf(photograph, layout));
    ASSERT_TRUE(image.ok());
    EXPECT_GT(LumaPsnr(*image, photograph), 52) << CellOf(layout);
  }
}

// Colours that change within a few pixels are no noise: rows and columns tell the same of them.
TEST(DemosaicTest, RestoresSharpColoursOfACleanFrame) {
  RgbImage colours(160, 120, 3);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double turn = 2 * std::numbers::pi;
      const double hue = std::sin(turn * x / 14) * std::cos(turn * y / 16), grey = std::cos(turn * (x + y) / 17);
      colours.At(x, y, 0) = static_cast<std::uint8_t>(120 + 40 * hue + 20 * grey);
      colours.At(x, y, 1) = static_cast<std::uint8_t>(110 - 20 * hue + 20 * grey);
      colours.At(x, y, 2) = static_cast<std::uint8_t>(90 - 10 * hue + 20 * grey);
    }
  }
  for (const FrameLayout layout : kLayouts) {
    const auto image = DevelopFrame(MosaicOf(colours, layout));
    ASSERT_TRUE(image.ok());
    EXPECT_GT(LumaPsnr(*image, colours), 36) << CellOf(layout);
    EXPECT_GT(Psnr(*image, colours), 32) << CellOf(layout);
  }
}

// A crack or a small rain spot is told by its colour.
TEST(DemosaicTest, KeepsTheColourOfASpotOfEightPixels) {
  RgbImage skin(40, 40, 3);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      const bool is_spot = x >= 16 && x < 24 && y >= 16 && y < 24;
      skin.At(x, y, 0) = is_spot ? 130 : 110, skin.At(x, y, 1) = is_spot ? 110 : 130, skin.At(x, y, 2) = 60;
    }
  }
  for (const FrameLayout layout : kLayouts) {
    const auto image = DevelopFrame(MosaicOf(skin, layout));
    ASSERT_TRUE(image.ok());
    for (const int x : {18, 19}) EXPECT_NEAR(image->At(x, 19, 0) - image->At(x, 19, 1), 20, 4) << CellOf(layout);
  }
}

TEST(DemosaicTest, CopiesColourAndGrey) {
  RawFrame grey;
  grey.width = grey.height = 4;
  grey.bytes.assign(16, 77);
  EXPECT_EQ(DevelopFrame(grey)->At(3, 3, 2), 77);
  grey.bytes.pop_back();
  EXPECT_EQ(DevelopFrame(grey).status().code(), "bad_frame");
}

}  // namespace
}  // namespace drupe
