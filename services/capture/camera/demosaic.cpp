#include "capture/camera/demosaic.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "capture/camera/agreed_detail.h"
#include "capture/camera/colour_differences.h"

namespace drupe {
namespace {

inline std::uint8_t Level(int value) {
  return static_cast<std::uint8_t>(std::min((std::max(value, 0) + kLevelSteps / 2) / kLevelSteps, 255));
}

/// The differences of a colour at the pixels behind its filter, as far as 1 into the margin.
struct CleanDifferences {
  /// Without what single edges or noise have spoilt, for colour: lines of two pixels, such as cracks, keep theirs.
  Lattice fine;
  /// Without what wider edges have spoilt, for luma, in which what is left shows as a pattern of pixels.
  Lattice even;
};

/// What is written of a picture reaches one place into the margin, and each filter before it farther.
CleanDifferences Clean(const MeasuredColour& measured) {
  static_assert(kMeasuredReach == 9);
  Lattice fine = Median3x3(measured.difference, 8);
  Lattice even = Smooth(Median3x3(Median3x3(fine, 7), 6), Smoothing::kLight, 5);
  RestoreAgreedDetail(measured, fine, even);
  return {std::move(fine), std::move(even)};
}

/// Red less green and blue less green at a pixel.
struct Differences {
  int red = 0, blue = 0;
};

/// What luma has more than green, in 1 / (256 kLevelSteps) grey levels (ITU-R BT.601).
inline int LumaLessGreen(Differences differences) {
  return 77 * differences.red + 29 * differences.blue;
}

/// A pixel from its sample, which is that of green plus `own` (0 where the filter is green): luma by the even
/// differences, colour by the fine ones.
inline void Put(int sample, int own, Differences even, Differences fine, std::uint8_t* out) {
  const int shift = LumaLessGreen({even.red - fine.red, even.blue - fine.blue});
  const int green = kLevelSteps * sample - own + ((shift + 128) >> 8);
  out[0] = Level(green + fine.red);
  out[1] = Level(green);
  out[2] = Level(green + fine.blue);
}

/// The differences of both colours about the pixels of a row with red and of the one below it.
class CellRow {
 public:
  /// Row j of the cells.
  CellRow(const Lattice& reds, const Lattice& blues, int j)
      : red_(reds.Row(j)), red_below_(reds.Row(j + 1)), blue_above_(blues.Row(j - 1)), blue_(blues.Row(j)) {}

  Differences AtRed(int i) const {
    return {red_[i], (blue_above_[i - 1] + blue_above_[i] + blue_[i - 1] + blue_[i]) >> 2};
  }
  Differences RightOfRed(int i) const { return {(red_[i] + red_[i + 1]) >> 1, (blue_above_[i] + blue_[i]) >> 1}; }
  Differences BelowRed(int i) const { return {(red_[i] + red_below_[i]) >> 1, (blue_[i - 1] + blue_[i]) >> 1}; }
  Differences AtBlue(int i) const {
    return {(red_[i] + red_[i + 1] + red_below_[i] + red_below_[i + 1]) >> 2, blue_[i]};
  }

 private:
  const std::int16_t *red_, *red_below_, *blue_above_, *blue_;
};

/// Calls even(x, i) at the first pixels of the cells i of a row and odd(x, i) at the second ones.
template <typename Even, typename Odd>
void ForEachPixel(int width, RedPlace red, const Even& even, const Odd& odd) {
  int x = 0, i = 0;
  if (red.x == 1) odd(x++, i++);
  for (; x + 1 < width; x += 2, ++i) even(x, i), odd(x + 1, i);
  if (x < width) even(x, i);
}

void WriteRedRow(const CellRow& even, const CellRow& fine, const std::uint8_t* samples, RedPlace red, int width,
                 std::uint8_t* out) {
  const auto at_red = [=](int x, int i) {
    const Differences differences = even.AtRed(i);
    Put(samples[x], differences.red, differences, fine.AtRed(i), out + 3 * x);
  };
  const auto at_green = [=](int x, int i) { Put(samples[x], 0, even.RightOfRed(i), fine.RightOfRed(i), out + 3 * x); };
  ForEachPixel(width, red, at_red, at_green);
}

void WriteBlueRow(const CellRow& even, const CellRow& fine, const std::uint8_t* samples, RedPlace red, int width,
                  std::uint8_t* out) {
  const auto at_green = [=](int x, int i) { Put(samples[x], 0, even.BelowRed(i), fine.BelowRed(i), out + 3 * x); };
  const auto at_blue = [=](int x, int i) {
    const Differences differences = even.AtBlue(i);
    Put(samples[x], differences.blue, differences, fine.AtBlue(i), out + 3 * x);
  };
  ForEachPixel(width, red, at_green, at_blue);
}

}  // namespace

RgbImage Demosaic(const std::uint8_t* mosaic, int width, int height, RedPlace red) {
  const ColourDifferences measured = MeasureDifferences(mosaic, width, height, red);
  const CleanDifferences reds = Clean(measured.red), blues = Clean(measured.blue);
  RgbImage image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    // Row j of cells holds a row of pixels with red and the one below it; the first may begin above the picture.
    const int from_red = y + red.y, j = from_red / 2;
    const CellRow even(reds.even, blues.even, j), fine(reds.fine, blues.fine, j);
    const auto write = from_red % 2 == 0 ? WriteRedRow : WriteBlueRow;
    write(even, fine, mosaic + static_cast<std::size_t>(y) * width, red, width, image.Row(y));
  }
  return image;
}

}  // namespace drupe
