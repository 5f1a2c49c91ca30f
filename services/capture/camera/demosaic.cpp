#include "capture/camera/demosaic.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace drupe {
namespace {

constexpr int kMargin = 8;  // of mirrored pixels: more than all filters together reach
constexpr int kUnit = 4;    // steps of a grey level in what is computed

using Plane = std::vector<std::int16_t>;

/// Mirroring about a pixel keeps the pattern of colours.
int Mirror(int i, int size) {
  i = std::abs(i) % (2 * (size - 1));
  return i < size ? i : 2 * (size - 1) - i;
}

/// A third, rounded.
int Third(int value) {
  return (value * 21845 + 32768) >> 16;
}

/// The method on one mosaic. All planes have the mosaic's mirrored margin, so that no filter meets a border; how far a
/// pass goes into it is its argument `reach`.
class Demosaicer {
 public:
  Demosaicer(const std::uint8_t* mosaic, int width, int height, RedPlace red)
      : width_(width), height_(height), red_(red), stride_(width + 2 * kMargin) {
    const std::size_t size = static_cast<std::size_t>(stride_) * (height + 2 * kMargin);
    for (Plane* plane : {&mosaic_, &green_, &red_difference_, &blue_difference_}) plane->resize(size);
    for (int y = -kMargin; y < height + kMargin; ++y) {
      const std::uint8_t* from = mosaic + static_cast<std::size_t>(Mirror(y, height)) * width;
      std::int16_t* to = mosaic_.data() + At(0, y);
      for (int x = 0; x < width; ++x) to[x] = from[x];
      for (int x = 1; x <= kMargin; ++x)
        to[-x] = from[Mirror(-x, width)], to[width - 1 + x] = from[Mirror(width - 1 + x, width)];
    }
  }

  void Run() {
    ChooseGreen();
    SpreadToGreen(3);
    SpreadToOpposite(2);
    SmoothOwn(2);
    SpreadToGreen(1);
    SmoothOpposite();
  }

  void Write(RgbImage& image) const {
    for (int y = 0; y < height_; ++y) {
      std::uint8_t* out = image.Row(y);
      std::size_t i = At(0, y);
      for (int x = 0; x < width_; ++x, ++i, out += 3) {
        const int green = green_[i];
        out[0] = Level(green + red_difference_[i]), out[1] = Level(green), out[2] = Level(green + blue_difference_[i]);
      }
    }
  }

 private:
  std::size_t At(int x, int y) const {
    return static_cast<std::size_t>(y + kMargin) * stride_ + static_cast<std::size_t>(x + kMargin);
  }
  static std::uint8_t Level(int value) {
    return static_cast<std::uint8_t>(std::clamp((value + kUnit / 2) >> 2, 0, 255));
  }
  bool IsRedRow(int y) const { return (y & 1) == red_.y; }
  /// The first column >= `from` of the row's pixels behind red or blue.
  int FirstColoured(int y, int from) const {
    const int parity = IsRedRow(y) ? red_.x : 1 - red_.x;
    return from + ((from ^ parity) & 1);
  }
  /// The difference that is measured in this row, and the other one.
  Plane& Own(int y) { return IsRedRow(y) ? red_difference_ : blue_difference_; }
  Plane& Opposite(int y) { return IsRedRow(y) ? blue_difference_ : red_difference_; }
  /// To the neighbours along the direction chosen at `i`.
  std::size_t StepAt(std::size_t i) const { return is_horizontal_[i] != 0 ? 1 : static_cast<std::size_t>(stride_); }

  /// The difference of a red or blue pixel to green interpolated along one direction (Hamilton & Adams): `step` is the
  /// way to the next pixel in it.
  int DifferenceAlong(std::size_t i, std::size_t step) const {
    const std::int16_t* p = mosaic_.data() + i;
    const auto s = static_cast<std::ptrdiff_t>(step);
    return kUnit * p[0] - (2 * (p[-s] + p[s]) + 2 * p[0] - p[-2 * s] - p[2 * s]);
  }

  Plane Differences(std::size_t step) const {
    Plane differences(mosaic_.size());
    constexpr int kReach = kMargin - 2;
    for (int y = -kReach; y < height_ + kReach; ++y) {
      for (int x = FirstColoured(y, -kReach); x < width_ + kReach; x += 2) {
        const std::size_t i = At(x, y);
        differences[i] = static_cast<std::int16_t>(DifferenceAlong(i, step));
      }
    }
    return differences;
  }

  /// How much the differences change along the direction around each pixel: the sum over 5 x 5 steps from one to the
  /// next but one, which lie evenly about the pixel.
  Plane Changes(const Plane& differences, std::size_t step) const {
    const int across = step == 1 ? 3 : 2, down = step == 1 ? 2 : 3;
    Plane changes(differences.size()), rows(differences.size()), sums(differences.size());
    for (std::size_t i = 0; i + 2 * step < differences.size(); ++i) {
      changes[i] = static_cast<std::int16_t>(std::abs(differences[i] - differences[i + 2 * step]) >> 2);
    }
    for (std::size_t i = 3; i + 2 < rows.size(); ++i) {
      const std::int16_t* p = changes.data() + i - across;
      rows[i] = static_cast<std::int16_t>(p[0] + p[1] + p[2] + p[3] + p[4]);
    }
    const auto s = static_cast<std::size_t>(stride_);
    for (std::size_t i = 3 * s; i + 2 * s < rows.size(); ++i) {
      const std::int16_t* p = rows.data() + i - down * s;
      sums[i] = static_cast<std::int16_t>(p[0] + p[s] + p[2 * s] + p[3 * s] + p[4 * s]);
    }
    return sums;
  }

  /// Green, and the own difference, of red and blue pixels: along the direction in which the differences change less.
  void ChooseGreen() {
    const Plane across = Differences(1), down = Differences(static_cast<std::size_t>(stride_));
    const Plane across_changes = Changes(across, 1), down_changes = Changes(down, static_cast<std::size_t>(stride_));
    is_horizontal_.resize(mosaic_.size());
    for (std::size_t i = 0; i < mosaic_.size(); ++i) {
      is_horizontal_[i] = across_changes[i] <= down_changes[i] ? 1 : 0;
      green_[i] = static_cast<std::int16_t>(kUnit * mosaic_[i]);
    }
    for (int y = -4; y < height_ + 4; ++y) {
      Plane& own = Own(y);
      for (int x = FirstColoured(y, -4); x < width_ + 4; x += 2) {
        const std::size_t i = At(x, y);
        own[i] = is_horizontal_[i] != 0 ? across[i] : down[i];
        green_[i] = static_cast<std::int16_t>(kUnit * mosaic_[i] - own[i]);
      }
    }
  }

  /// Both differences at green pixels, from the two neighbours that have each.
  void SpreadToGreen(int reach) {
    const auto s = static_cast<std::size_t>(stride_);
    for (int y = -reach; y < height_ + reach; ++y) {
      Plane &in_row = Own(y), &in_column = Opposite(y);
      for (int x = FirstColoured(y, -reach) == -reach ? 1 - reach : -reach; x < width_ + reach; x += 2) {
        const std::size_t i = At(x, y);
        in_row[i] = static_cast<std::int16_t>((in_row[i - 1] + in_row[i + 1]) >> 1);
        in_column[i] = static_cast<std::int16_t>((in_column[i - s] + in_column[i + s]) >> 1);
      }
    }
  }

  /// Blue at red pixels and red at blue ones: blue less red along the chosen direction.
  void SpreadToOpposite(int reach) {
    for (int y = -reach; y < height_ + reach; ++y) {
      Plane &own = Own(y), &opposite = Opposite(y);
      for (int x = FirstColoured(y, -reach); x < width_ + reach; x += 2) {
        const std::size_t i = At(x, y), before = i - StepAt(i), after = i + StepAt(i);
        const int sum = opposite[before] - own[before] + opposite[after] - own[after];
        opposite[i] = static_cast<std::int16_t>(own[i] + (sum >> 1));
      }
    }
  }

  /// Smooths the own difference of red and blue pixels along the chosen direction; green follows.
  void SmoothOwn(int reach) {
    for (int y = -reach; y < height_ + reach; ++y) {
      Plane& own = Own(y);
      for (int x = FirstColoured(y, -reach); x < width_ + reach; x += 2) {
        const std::size_t i = At(x, y), step = StepAt(i);
        const int before = own[i];
        own[i] = static_cast<std::int16_t>(Third(own[i - step] + before + own[i + step]));
        green_[i] = static_cast<std::int16_t>(kUnit * mosaic_[i] - own[i]);
        Opposite(y)[i] = static_cast<std::int16_t>(Opposite(y)[i] + own[i] - before);  // keeps blue as it is
      }
    }
  }

  /// The same with blue less red.
  void SmoothOpposite() {
    for (int y = 0; y < height_; ++y) {
      Plane &own = Own(y), &opposite = Opposite(y);
      for (int x = FirstColoured(y, 0); x < width_; x += 2) {
        const std::size_t i = At(x, y), before = i - StepAt(i), after = i + StepAt(i);
        const int sum = opposite[before] - own[before] + opposite[i] - own[i] + opposite[after] - own[after];
        opposite[i] = static_cast<std::int16_t>(own[i] + Third(sum));
      }
    }
  }

  const int width_, height_;
  const RedPlace red_;
  const int stride_;
  Plane mosaic_;  ///< grey levels; the rest in units of a quarter of one
  Plane green_;
  Plane red_difference_, blue_difference_;   ///< red less green, blue less green
  std::vector<std::uint8_t> is_horizontal_;  ///< the direction chosen at each pixel
};

}  // namespace

RgbImage Demosaic(const std::uint8_t* mosaic, int width, int height, RedPlace red) {
  RgbImage image(width, height, 3);
  Demosaicer demosaicer(mosaic, width, height, red);
  demosaicer.Run();
  demosaicer.Write(image);
  return image;
}

}  // namespace drupe
