#include "capture/camera/colour_differences.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace drupe {
namespace {

using Value = std::int16_t;

/// Pixels of the margin that measured cells cover, and those as far as which filters before them reach.
constexpr int kPixelReach = 2 * kMeasuredReach + 1, kChangeReach = kPixelReach + 2, kContrastReach = kChangeReach + 3;
static_assert(kContrastReach + 2 <= Lattice::kMargin);

/// Mirroring about a pixel keeps the pattern of colours.
int Mirror(int i, int size) {
  i = std::abs(i) % (2 * (size - 1));
  return i < size ? i : 2 * (size - 1) - i;
}

/// The samples of all colours.
Lattice Mirrored(const std::uint8_t* mosaic, int width, int height) {
  Lattice samples(width, height);
  for (int y = -Lattice::kMargin; y < height + Lattice::kMargin; ++y) {
    const std::uint8_t* from = mosaic + static_cast<std::size_t>(Mirror(y, height)) * width;
    Value* to = samples.Row(y);
    std::copy_n(from, width, to);
    for (int x = 1; x <= Lattice::kMargin; ++x) to[-x] = from[Mirror(-x, width)];
    for (int x = width; x < width + Lattice::kMargin; ++x) to[x] = from[Mirror(x, width)];
  }
  return samples;
}

/// The colour of each pixel less that of the pixels beside it along a direction, both interpolated; `step` leads to the
/// next pixel in it. At a pixel behind green that is green less the row's or column's colour.
Lattice ContrastsAlong(const Lattice& samples, std::ptrdiff_t step) {
  static_assert(kLevelSteps == 4);
  Lattice contrasts(samples.columns(), samples.rows());
  for (int y = -kContrastReach; y < samples.rows() + kContrastReach; ++y) {
    const Value* s = samples.Row(y);
    Value* out = contrasts.Row(y);
    for (int x = -kContrastReach; x < samples.columns() + kContrastReach; ++x) {
      out[x] = static_cast<Value>(2 * s[x] + s[x - 2 * step] + s[x + 2 * step] - 2 * (s[x - step] + s[x + step]));
    }
  }
  return contrasts;
}

/// Sums of a row's values and the two on both sides of each, halved.
void HalfSumsOfFive(const Value* values, int begin, int end, Value* out) {
  for (int x = begin; x < end; ++x) {
    out[x] = static_cast<Value>((values[x - 2] + values[x - 1] + values[x] + values[x + 1] + values[x + 2]) >> 1);
  }
}

/// Half of how much contrasts change along their direction, each from the pixel before to the one after, summed over
/// 5 x 5 pixels: 25 changes of at most 2040 each.
Lattice ChangesAround(const Lattice& contrasts, std::ptrdiff_t step) {
  Lattice changes(contrasts.columns(), contrasts.rows());
  std::vector<Value> columns(static_cast<std::size_t>(changes.stride()));
  Value* of_column = columns.data() + Lattice::kMargin;
  for (int y = -kChangeReach; y < changes.rows() + kChangeReach; ++y) {
    std::fill(columns.begin(), columns.end(), Value{0});
    for (int j = y - 2; j <= y + 2; ++j) {
      const Value* c = contrasts.Row(j);
      for (int x = -kChangeReach - 2; x < changes.columns() + kChangeReach + 2; ++x) {
        const auto change = static_cast<Value>(c[x + step] - c[x - step]);
        of_column[x] = static_cast<Value>(of_column[x] + std::max(change, static_cast<Value>(-change)));
      }
    }
    HalfSumsOfFive(of_column, -kChangeReach, changes.columns() + kChangeReach, changes.Row(y));
  }
  return changes;
}

/// What is known along one direction.
struct Direction {
  Direction(const Lattice& samples, std::ptrdiff_t along)
      : step(along), contrasts(ContrastsAlong(samples, along)), changes(ChangesAround(contrasts, along)) {}

  std::ptrdiff_t step;
  Lattice contrasts, changes;
};

/// Where differences change little, they may be averaged.
inline float WeightOf(Value changes) {
  const float more = static_cast<float>(changes) + 1;
  const float square = more * more;
  return 1 / (square * square);
}

/// The sum of a colour's differences at four pixels from `contrast` on; they change sides from pixel to pixel.
inline float SumOfFour(const Value* contrast, std::ptrdiff_t step) {
  return static_cast<float>(contrast[0] - contrast[step] + contrast[2 * step] - contrast[3 * step]);
}

/// The difference at a pixel, from the contrasts and the changes around it along both directions.
inline Value Weighed(const Value* across, const Value* down, std::ptrdiff_t stride, const Value* across_changes,
                     const Value* down_changes) {
  const float left = WeightOf(across_changes[-2]), right = WeightOf(across_changes[2]);
  const float above = WeightOf(down_changes[-2 * stride]), below = WeightOf(down_changes[2 * stride]);
  const float sum = (left * SumOfFour(across, -1) + right * SumOfFour(across, 1)) +
                    (above * SumOfFour(down, -stride) + below * SumOfFour(down, stride));
  return RoundedSteps(sum / (4 * ((left + right) + (above + below))));
}

/// Red's, or blue's, from the cells' pixels at (place_x, place_y).
MeasuredColour Collect(const Lattice& samples, const Direction& across, const Direction& down, int columns, int rows,
                       int place_x, int place_y) {
  const Lattice empty(columns, rows);
  MeasuredColour colour{empty, {empty, empty, empty}, {empty, empty, empty}};
  const std::ptrdiff_t stride = down.step;
  for (int j = -kMeasuredReach; j < rows + kMeasuredReach; ++j) {
    const int y = 2 * j + place_y;
    const Value *a = across.contrasts.Row(y) + place_x, *d = down.contrasts.Row(y) + place_x;
    const Value *a_changes = across.changes.Row(y) + place_x, *d_changes = down.changes.Row(y) + place_x;
    Value *difference = colour.difference.Row(j), *a_own = colour.across.own.Row(j), *d_own = colour.down.own.Row(j);
    const Value* s = samples.Row(y) + place_x;
    Value *a_step = colour.across.step.Row(j), *d_step = colour.down.step.Row(j);
    Value *a_sum = colour.across.of_three.Row(j), *d_sum = colour.down.of_three.Row(j);
    for (int i = -kMeasuredReach; i < columns + kMeasuredReach; ++i) {
      const int x = 2 * i;
      difference[i] = Weighed(a + x, d + x, stride, a_changes + x, d_changes + x);
      a_own[i] = a[x], d_own[i] = d[x];
      a_step[i] = static_cast<Value>(s[x + 2] - s[x - 2]);
      d_step[i] = static_cast<Value>(s[x + 2 * stride] - s[x - 2 * stride]);
      a_sum[i] = static_cast<Value>(a[x] - a[x - 1] - a[x + 1]);
      d_sum[i] = static_cast<Value>(d[x] - d[x - stride] - d[x + stride]);
    }
  }
  return colour;
}

}  // namespace

ColourDifferences MeasureDifferences(const std::uint8_t* mosaic, int width, int height, RedPlace red) {
  const Lattice samples = Mirrored(mosaic, width, height);
  const Direction across(samples, 1), down(samples, samples.stride());
  const int columns = (width + red.x + 1) / 2, rows = (height + red.y + 1) / 2;
  return {Collect(samples, across, down, columns, rows, -red.x, -red.y),
          Collect(samples, across, down, columns, rows, 1 - red.x, 1 - red.y)};
}

}  // namespace drupe
