// Demosaic against the same method written pixel by pixel, without lattices.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include "capture/camera/demosaic.h"

namespace drupe {
namespace {

int MirroredIndex(int i, int size) {
  i = std::abs(i) % (2 * (size - 1));
  return i < size ? i : 2 * (size - 1) - i;
}

/// Values at pixels in and around the picture.
class Field {
 public:
  static constexpr int kAround = 16;
  Field(int width, int height)
      : stride_(width + 2 * kAround), values_(static_cast<std::size_t>(stride_) * (height + 2 * kAround)) {}
  int& At(int x, int y) { return values_[static_cast<std::size_t>((y + kAround) * stride_ + x + kAround)]; }
  int At(int x, int y) const { return values_[static_cast<std::size_t>((y + kAround) * stride_ + x + kAround)]; }

 private:
  int stride_;
  std::vector<int> values_;
};

/// The method on one mosaic; differences in quarters of a grey level.
class PlainDemosaic {
 public:
  PlainDemosaic(const std::vector<std::uint8_t>& mosaic, int width, int height, RedPlace red)
      : mosaic_(mosaic), width_(width), height_(height), red_(red), differences_(width, height), fine_(width, height) {
    ForAllWithin(10, [&](int x, int y) { return Chosen(x, y); });
    ForAllWithin(8, [&](int x, int y) { return Median(x, y); });
    fine_ = differences_;
    for (int around : {6, 4}) ForAllWithin(around, [&](int x, int y) { return Median(x, y); });
    ForAllWithin(4, [&](int x, int y) { return Weighed(x, y, 0, 2); });
    ForAllWithin(2, [&](int x, int y) { return Weighed(x, y, 2, 0); });
  }

  /// Channel 0..2 of a pixel.
  int Colour(int x, int y, int channel) const {
    const int own = IsGreen(x, y) ? 0 : differences_.At(x, y);
    const int red = Interpolated(fine_, x, y, true), blue = Interpolated(fine_, x, y, false);
    const int luma_excess =
        77 * (Interpolated(differences_, x, y, true) - red) + 29 * (Interpolated(differences_, x, y, false) - blue);
    const int green = 4 * Sample(x, y) - own + ((luma_excess + 128) >> 8);
    const int less_green = channel == 0 ? red : channel == 1 ? 0 : blue;
    return std::clamp((std::max(green + less_green, 0) + 2) / 4, 0, 255);
  }

 private:
  bool IsRedRow(int y) const { return (y & 1) == red_.y; }
  bool IsRedColumn(int x) const { return (x & 1) == red_.x; }
  bool IsGreen(int x, int y) const { return IsRedRow(y) != IsRedColumn(x); }
  int Sample(int x, int y) const {
    return mosaic_[static_cast<std::size_t>(MirroredIndex(y, height_) * width_ + MirroredIndex(x, width_))];
  }
  /// Of a red or blue pixel to green, which is interpolated along (dx, dy).
  int Along(int x, int y, int dx, int dy) const {
    return 2 * Sample(x, y) + Sample(x - 2 * dx, y - 2 * dy) + Sample(x + 2 * dx, y + 2 * dy) -
           2 * (Sample(x - dx, y - dy) + Sample(x + dx, y + dy));
  }
  /// The sum of changes over the 5 x 5 steps whose middles lie about the pixel.
  int Changes(int x, int y, int dx, int dy) const {
    int sum = 0;
    for (int v = y - 2 - dy; v <= y + 2 - dy; ++v) {
      for (int u = x - 2 - dx; u <= x + 2 - dx; ++u) {
        if (!IsGreen(u, v)) sum += std::abs(Along(u, v, dx, dy) - Along(u + 2 * dx, v + 2 * dy, dx, dy));
      }
    }
    return sum;
  }
  int Chosen(int x, int y) const {
    return Changes(x, y, 1, 0) <= Changes(x, y, 0, 1) ? Along(x, y, 1, 0) : Along(x, y, 0, 1);
  }
  int Median(int x, int y) const {
    std::vector<int> values;
    for (int v = y - 2; v <= y + 2; v += 2) {
      for (int u = x - 2; u <= x + 2; u += 2) values.push_back(differences_.At(u, v));
    }
    std::sort(values.begin(), values.end());
    return values[4];
  }
  int Weighed(int x, int y, int dx, int dy) const {
    return (differences_.At(x - dx, y - dy) + 6 * differences_.At(x, y) + differences_.At(x + dx, y + dy) + 4) >> 3;
  }
  /// The mean of the nearest differences of red or of blue.
  int Interpolated(const Field& differences, int x, int y, bool of_red) const {
    const int dx = IsRedColumn(x) == of_red ? 0 : 1, dy = IsRedRow(y) == of_red ? 0 : 1;
    const int sum = differences.At(x - dx, y - dy) + differences.At(x + dx, y - dy) + differences.At(x - dx, y + dy) +
                    differences.At(x + dx, y + dy);
    return sum >> 2;
  }

  template <typename Value>
  void ForAllWithin(int around, const Value& value) {
    Field next(width_, height_);
    for (int y = -around; y < height_ + around; ++y) {
      for (int x = -around; x < width_ + around; ++x) {
        if (!IsGreen(x, y)) next.At(x, y) = value(x, y);
      }
    }
    differences_ = next;
  }

  const std::vector<std::uint8_t>& mosaic_;
  int width_, height_;
  RedPlace red_;
  Field differences_;  ///< of red at red pixels, of blue at blue ones
  Field fine_;         ///< the same after the first median
};

void ExpectAsPlain(const std::vector<std::uint8_t>& mosaic, int width, int height, RedPlace red) {
  const RgbImage image = Demosaic(mosaic.data(), width, height, red);
  const PlainDemosaic plain(mosaic, width, height, red);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        ASSERT_EQ(image.At(x, y, c), plain.Colour(x, y, c))
            << width << 'x' << height << " red " << red.x << ' ' << red.y << " at " << x << ' ' << y << ' ' << c;
      }
    }
  }
}

TEST(DemosaicReferenceTest, IsTheMethodWrittenPixelByPixel) {
  std::mt19937 random(1);
  for (const auto& [width, height] : {std::pair{4, 4}, {5, 4}, {4, 7}, {16, 9}, {41, 33}, {38, 26}}) {
    for (int place = 0; place < 4; ++place) {
      std::vector<std::uint8_t> mosaic(static_cast<std::size_t>(width * height));
      for (std::uint8_t& sample : mosaic) sample = static_cast<std::uint8_t>(random());
      ExpectAsPlain(mosaic, width, height, {place & 1, place >> 1});
    }
  }
}

}  // namespace
}  // namespace drupe
