#include "capture/camera/colour_differences.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace drupe {
namespace {

using Value = std::int16_t;

/// Mirroring about a pixel keeps the pattern of colours.
int Mirror(int i, int size) {
  i = std::abs(i) % (2 * (size - 1));
  return i < size ? i : 2 * (size - 1) - i;
}

/// The samples of a mosaic, mirrored into the margins, by their place in the cell.
struct Samples {
  Samples(const std::uint8_t* mosaic, int width, int height, RedPlace place)
      : columns((width + place.x + 1) / 2),
        rows((height + place.y + 1) / 2),
        red_place(place),
        red(columns, rows),
        right_of_red(columns, rows),
        below_red(columns, rows),
        blue(columns, rows) {
    for (int j = -Lattice::kMargin; j < rows + Lattice::kMargin; ++j) {
      const auto row = [&](int y) { return mosaic + static_cast<std::size_t>(Mirror(y, height)) * width; };
      SplitRow(row(2 * j - place.y), width, red.Row(j), right_of_red.Row(j));
      SplitRow(row(2 * j + 1 - place.y), width, below_red.Row(j), blue.Row(j));
    }
  }

  int columns, rows;
  RedPlace red_place;
  Lattice red, right_of_red, below_red, blue;

 private:
  void SplitRow(const std::uint8_t* from, int width, Value* even, Value* odd) const {
    const auto mirrored = [&](int i) {
      even[i] = from[Mirror(2 * i - red_place.x, width)];
      odd[i] = from[Mirror(2 * i + 1 - red_place.x, width)];
    };
    for (int i = -Lattice::kMargin; i <= 0; ++i) mirrored(i);
    for (int i = 1; i < columns - 1; ++i) {
      even[i] = from[2 * i - red_place.x];
      odd[i] = from[2 * i + 1 - red_place.x];
    }
    for (int i = std::max(1, columns - 1); i < columns + Lattice::kMargin; ++i) mirrored(i);
  }
};

/// Differences of a colour to green interpolated along one direction: `step` leads to the colour's next sample in it,
/// and `before`, `after` are the green samples between.
Lattice DifferencesAlong(const Lattice& colour, const Lattice& green, std::ptrdiff_t before, std::ptrdiff_t after,
                         std::ptrdiff_t step) {
  static_assert(kLevelSteps == 4);
  constexpr int kReach = Lattice::kMargin - 1;
  Lattice differences(colour.columns(), colour.rows());
  for (int y = -kReach; y < colour.rows() + kReach; ++y) {
    const Value *c = colour.Row(y), *g = green.Row(y);
    Value* out = differences.Row(y);
    for (int x = -kReach; x < colour.columns() + kReach; ++x) {
      out[x] = static_cast<Value>(2 * c[x] + c[x - step] + c[x + step] - 2 * (g[x + before] + g[x + after]));
    }
  }
  return differences;
}

/// Which of a lattice's changes, each from one value to the next along a direction, are summed: rows and columns
/// relative to the pixel, first and last.
struct Window {
  int top, bottom, left, right;
};

/// Sums changes around each pixel of a row.
class ChangeSums {
 public:
  explicit ChangeSums(int columns, int reach)
      : reach_(reach),
        changes_(static_cast<std::size_t>(columns + 2 * Lattice::kMargin)),
        sums_(static_cast<std::size_t>(columns + 2 * reach)) {}

  void Clear() { std::fill(sums_.begin(), sums_.end(), Value{0}); }
  /// At most 12 changes of at most 2040 each: the sum of what is added between two calls of Clear fits.
  void Add(const Lattice& differences, std::ptrdiff_t step, int y, const Window& window) {
    constexpr int kChangeReach = Lattice::kMargin - 2;
    std::fill(changes_.begin(), changes_.end(), Value{0});
    Value* changes = changes_.data() + Lattice::kMargin;
    for (int j = y + window.top; j <= y + window.bottom; ++j) {
      const Value* d = differences.Row(j);
      for (int x = -kChangeReach; x < differences.columns() + kChangeReach; ++x) {
        const auto change = static_cast<Value>(d[x] - d[x + step]);
        changes[x] = static_cast<Value>(changes[x] + std::max(change, static_cast<Value>(-change)));
      }
    }
    for (int left = window.left; left <= window.right; ++left) {
      const Value* from = changes - reach_ + left;
      for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] = static_cast<Value>(sums_[i] + from[i]);
    }
  }
  const Value* sums() const { return sums_.data() + reach_; }

 private:
  int reach_;
  std::vector<Value> changes_, sums_;
};

/// One colour's differences along both directions.
struct Directions {
  Lattice across, down;
};

/// The 5 x 5 pixels about a pixel, as seen from the lattice of its own colour and from the other one.
struct Neighbourhood {
  Window own_across, own_down, other_across, other_down;
};
constexpr Neighbourhood kAboutRed = {{-1, 1, -1, 0}, {-1, 0, -1, 1}, {-1, 0, -2, 0}, {-2, 0, -1, 0}};
constexpr Neighbourhood kAboutBlue = {{-1, 1, -1, 0}, {-1, 0, -1, 1}, {0, 1, -1, 1}, {-1, 1, 0, 1}};

/// A colour's differences along the direction in which those of both colours change less.
Lattice Choose(const Directions& own, const Directions& other, const Neighbourhood& about, int reach) {
  Lattice chosen(own.across.columns(), own.across.rows());
  ChangeSums across(chosen.columns(), reach), down(chosen.columns(), reach);
  const std::ptrdiff_t stride = chosen.stride();
  for (int y = -reach; y < chosen.rows() + reach; ++y) {
    across.Clear(), down.Clear();
    across.Add(own.across, 1, y, about.own_across), across.Add(other.across, 1, y, about.other_across);
    down.Add(own.down, stride, y, about.own_down), down.Add(other.down, stride, y, about.other_down);
    const Value *changes_across = across.sums(), *changes_down = down.sums();
    const Value *d_across = own.across.Row(y), *d_down = own.down.Row(y);
    Value* out = chosen.Row(y);
    for (int x = -reach; x < chosen.columns() + reach; ++x) {
      out[x] = changes_across[x] <= changes_down[x] ? d_across[x] : d_down[x];
    }
  }
  return chosen;
}

}  // namespace

ColourDifferences MeasureDifferences(const std::uint8_t* mosaic, int width, int height, RedPlace red, int reach) {
  const Samples s(mosaic, width, height, red);
  const std::ptrdiff_t stride = s.red.stride();
  const Directions reds{DifferencesAlong(s.red, s.right_of_red, -1, 0, 1),
                        DifferencesAlong(s.red, s.below_red, -stride, 0, stride)};
  const Directions blues{DifferencesAlong(s.blue, s.below_red, 0, 1, 1),
                         DifferencesAlong(s.blue, s.right_of_red, 0, stride, stride)};
  return {Choose(reds, blues, kAboutRed, reach), Choose(blues, reds, kAboutBlue, reach)};
}

}  // namespace drupe
