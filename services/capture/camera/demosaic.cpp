#include "capture/camera/demosaic.h"

#include <algorithm>
#include <cstdint>

#include "capture/camera/colour_differences.h"

namespace drupe {
namespace {

inline std::uint8_t Level(int value) {
  return static_cast<std::uint8_t>(std::min((std::max(value, 0) + kLevelSteps / 2) / kLevelSteps, 255));
}

/// Differences without those that an edge or noise has spoilt, as far as 1 into the margin from 5.
Lattice Clean(const Lattice& measured) {
  return Smooth(Median3x3(Median3x3(Median3x3(measured, 4), 3), 2), 1);
}

/// Red less green and blue less green at a pixel.
struct Differences {
  int red = 0, blue = 0;
};

/// A pixel from its sample, which is that of green plus `own` (0 where the filter is green).
inline void Put(int sample, int own, Differences differences, std::uint8_t* out) {
  const int green = kLevelSteps * sample - own;
  out[0] = Level(green + differences.red);
  out[1] = Level(green);
  out[2] = Level(green + differences.blue);
}

/// The colours of a mosaic from the differences measured at red and at blue pixels.
class Assembly {
 public:
  Assembly(const std::uint8_t* mosaic, RedPlace red, const Lattice& reds, const Lattice& blues)
      : mosaic_(mosaic), red_(red), reds_(reds), blues_(blues) {}

  void Write(RgbImage& image) const {
    for (int y = 0; y < image.height(); ++y) {
      // Row j of cells holds a row of pixels with red and the one below it; the first may begin above the picture.
      const int from_red = y + red_.y, j = from_red / 2;
      const std::uint8_t* samples = mosaic_ + static_cast<std::size_t>(y) * image.width();
      if (from_red % 2 == 0) {
        WriteRedRow(j, samples, image.width(), image.Row(y));
      } else {
        WriteBlueRow(j, samples, image.width(), image.Row(y));
      }
    }
  }

 private:
  /// Calls even(x, i) at the first pixels of the cells i of a row and odd(x, i) at the second ones.
  template <typename Even, typename Odd>
  void ForEachPixel(int width, const Even& even, const Odd& odd) const {
    int x = 0, i = 0;
    if (red_.x == 1) odd(x++, i++);
    for (; x + 1 < width; x += 2, ++i) even(x, i), odd(x + 1, i);
    if (x < width) even(x, i);
  }

  void WriteRedRow(int j, const std::uint8_t* samples, int width, std::uint8_t* out) const {
    const std::int16_t *red = reds_.Row(j), *above = blues_.Row(j - 1), *below = blues_.Row(j);
    const auto at_red = [=](int x, int i) {
      Put(samples[x], red[i], {red[i], (above[i - 1] + above[i] + below[i - 1] + below[i]) >> 2}, out + 3 * x);
    };
    const auto at_green = [=](int x, int i) {
      Put(samples[x], 0, {(red[i] + red[i + 1]) >> 1, (above[i] + below[i]) >> 1}, out + 3 * x);
    };
    ForEachPixel(width, at_red, at_green);
  }

  void WriteBlueRow(int j, const std::uint8_t* samples, int width, std::uint8_t* out) const {
    const std::int16_t *blue = blues_.Row(j), *above = reds_.Row(j), *below = reds_.Row(j + 1);
    const auto at_green = [=](int x, int i) {
      Put(samples[x], 0, {(above[i] + below[i]) >> 1, (blue[i - 1] + blue[i]) >> 1}, out + 3 * x);
    };
    const auto at_blue = [=](int x, int i) {
      Put(samples[x], blue[i], {(above[i] + above[i + 1] + below[i] + below[i + 1]) >> 2, blue[i]}, out + 3 * x);
    };
    ForEachPixel(width, at_green, at_blue);
  }

  const std::uint8_t* mosaic_;
  RedPlace red_;
  const Lattice& reds_;
  const Lattice& blues_;
};

}  // namespace

RgbImage Demosaic(const std::uint8_t* mosaic, int width, int height, RedPlace red) {
  // What is written reaches one place into the lattices' margin, and each filter before it one farther.
  const ColourDifferences measured = MeasureDifferences(mosaic, width, height, red, 5);
  const Lattice reds = Clean(measured.red), blues = Clean(measured.blue);
  RgbImage image(width, height, 3);
  Assembly(mosaic, red, reds, blues).Write(image);
  return image;
}

}  // namespace drupe
