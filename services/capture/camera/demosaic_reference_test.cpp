// Demosaic against the same method written pixel by pixel, without lattices.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
  static constexpr int kAround = 32;
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
    ForAllWithin(18, [&](int x, int y) { return Measured(x, y); });
    const Field measured = differences_;
    ForAllWithin(16, [&](int x, int y) { return Median(x, y); });
    fine_ = differences_;
    for (int around : {14, 12}) ForAllWithin(around, [&](int x, int y) { return Median(x, y); });
    ForAllWithin(12, [&](int x, int y) { return Weighed(x, y, 0, 2, 6); });
    ForAllWithin(10, [&](int x, int y) { return Weighed(x, y, 2, 0, 6); });
    const Field even = differences_;
    ForAllWithin(10, [&](int x, int y) { return Weighed(x, y, 0, 2, 2); });
    ForAllWithin(8, [&](int x, int y) { return Weighed(x, y, 2, 0, 2); });
    Field restored_fine = fine_;
    const auto restored = [&](int x, int y) {
      const float share = ShareKept(x, y);
      restored_fine.At(x, y) = Towards(fine_.At(x, y), measured.At(x, y), share);
      return Towards(even.At(x, y), measured.At(x, y), share);
    };
    ForAllWithin(2, restored);
    fine_ = restored_fine;
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
  /// Of a pixel's colour to the one of the pixels beside it along (dx, dy).
  int Contrast(int x, int y, int dx, int dy) const {
    return 2 * Sample(x, y) + Sample(x - 2 * dx, y - 2 * dy) + Sample(x + 2 * dx, y + 2 * dy) -
           2 * (Sample(x - dx, y - dy) + Sample(x + dx, y + dy));
  }
  /// To the power of -4: changes along (dx, dy) in the 5 x 5 pixels that begin at the pixel and go on to one side.
  float Weight(int x, int y, int dx, int dy, int side) const {
    int sum = 0;
    for (int v = y - 2 + 2 * side * dy; v <= y + 2 + 2 * side * dy; ++v) {
      for (int u = x - 2 + 2 * side * dx; u <= x + 2 + 2 * side * dx; ++u) {
        sum += std::abs(Contrast(u + dx, v + dy, dx, dy) - Contrast(u - dx, v - dy, dx, dy));
      }
    }
    const float more = static_cast<float>(sum / 2) + 1, square = more * more;
    return 1 / (square * square);
  }
  /// Red or blue less green at four pixels from (x, y) on.
  float SumOfFour(int x, int y, int dx, int dy) const {
    int sum = 0;
    for (int i = 0; i < 4; ++i) sum += (i % 2 == 0 ? 1 : -1) * Contrast(x + i * dx, y + i * dy, dx, dy);
    return static_cast<float>(sum);
  }
  static int Round(float value) { return static_cast<int>(std::floor(value + 0.5F)); }
  int Measured(int x, int y) const {
    const float left = Weight(x, y, 1, 0, -1), right = Weight(x, y, 1, 0, 1);
    const float up = Weight(x, y, 0, 1, -1), down = Weight(x, y, 0, 1, 1);
    const float sum = (left * SumOfFour(x, y, -1, 0) + right * SumOfFour(x, y, 1, 0)) +
                      (up * SumOfFour(x, y, 0, -1) + down * SumOfFour(x, y, 0, 1));
    return Round(sum / (4 * ((left + right) + (up + down))));
  }
  int Thrice(int x, int y, int dx, int dy) const {
    return Contrast(x, y, dx, dy) - Contrast(x - dx, y - dy, dx, dy) - Contrast(x + dx, y + dy, dx, dy);
  }
  float ShareKept(int x, int y) const {
    int common = 0, all = 0;
    for (int v = y - 6; v <= y + 6; v += 2) {
      for (int u = x - 6; u <= x + 6; u += 2) {
        const int across = (Thrice(u, v, 1, 0) - 3 * differences_.At(u, v)) >> 1;
        const int down = (Thrice(u, v, 0, 1) - 3 * differences_.At(u, v)) >> 1;
        const int bend_across = (Thrice(u, v, 1, 0) - 3 * Contrast(u, v, 1, 0)) >> 1;
        const int bend_down = (Thrice(u, v, 0, 1) - 3 * Contrast(u, v, 0, 1)) >> 1;
        common += 2 * across * down;
        const int step_across = Sample(u + 2, v) - Sample(u - 2, v), step_down = Sample(u, v + 2) - Sample(u, v - 2);
        all += across * across + down * down + ((bend_across * bend_across + bend_down * bend_down) >> 1);
        all += step_across * step_across + step_down * step_down;
      }
    }
    const float agreed = 2 * static_cast<float>(common) - static_cast<float>(all);
    return agreed > 0 ? 8 * agreed / (7 * agreed + static_cast<float>(all)) : 0;
  }
  static int Towards(int filtered, int measured, float share) {
    return Round(static_cast<float>(filtered) + share * static_cast<float>(measured - filtered));
  }
  int Median(int x, int y) const {
    std::vector<int> values;
    for (int v = y - 2; v <= y + 2; v += 2) {
      for (int u = x - 2; u <= x + 2; u += 2) values.push_back(differences_.At(u, v));
    }
    std::sort(values.begin(), values.end());
    return values[4];
  }
  /// With both neighbours, as 1 : middle : 1.
  int Weighed(int x, int y, int dx, int dy, int middle) const {
    const int sum = differences_.At(x - dx, y - dy) + middle * differences_.At(x, y) + differences_.At(x + dx, y + dy);
    return static_cast<int>(std::floor(sum / (middle + 2.0) + 0.5));
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
