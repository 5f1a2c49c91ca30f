#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace drupe {

/// Steps of a grey level in differences of colours.
constexpr int kLevelSteps = 4;

/// To the nearest step, for differences of more than -4096.
inline std::int16_t RoundedSteps(float difference) {
  return static_cast<std::int16_t>(static_cast<int>(difference + 4096.5F) - 4096);
}

/// Values at all pixels, or at every second pixel of every second row, with a margin on all sides, so that no filter
/// meets a border: columns -kMargin..columns() + kMargin - 1, and rows likewise, may be read and written. Zero at
/// first.
class Lattice {
 public:
  static constexpr int kMargin = 28;

  Lattice(int columns, int rows)
      : columns_(columns),
        rows_(rows),
        values_(static_cast<std::size_t>(columns + 2 * kMargin) * static_cast<std::size_t>(rows + 2 * kMargin)) {}

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// Values from one row to the next.
  std::ptrdiff_t stride() const { return columns_ + 2 * kMargin; }
  std::int16_t* Row(int y) { return values_.data() + (y + kMargin) * stride() + kMargin; }
  const std::int16_t* Row(int y) const { return values_.data() + (y + kMargin) * stride() + kMargin; }

 private:
  int columns_, rows_;
  std::vector<std::int16_t> values_;
};

/// The median of each value and its eight neighbours, as far as `reach` into the margin.
Lattice Median3x3(const Lattice& from, int reach);

/// How much of a smoothed value its neighbours on both sides have, across and down.
enum class Smoothing { kLight /** 1 : 6 : 1 */, kStrong /** 1 : 2 : 1 */ };

/// Each value and its neighbours weighed, as far as `reach` into the margin.
Lattice Smooth(const Lattice& from, Smoothing smoothing, int reach);

}  // namespace drupe
