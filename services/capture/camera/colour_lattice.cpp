#include "capture/camera/colour_lattice.h"

#include <algorithm>
#include <array>

namespace drupe {
namespace {

using Entry = std::int16_t;

Entry Middle(Entry a, Entry b, Entry c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

/// A row's values and those above and below each, in order.
struct SortedColumns {
  std::vector<Entry> low, middle, high;
};

/// Plain loops over rows, which compilers turn into vector code.
void SortColumns(std::array<const Entry*, 3> rows, std::size_t count, SortedColumns& sorted) {
  Entry *low = sorted.low.data(), *middle = sorted.middle.data(), *high = sorted.high.data();
  for (std::size_t i = 0; i < count; ++i) {
    const Entry a = rows[0][i], b = rows[1][i], c = rows[2][i];
    low[i] = std::min(std::min(a, b), c);
    middle[i] = Middle(a, b, c);
    high[i] = std::max(std::max(a, b), c);
  }
}

/// The median of nine is that of the largest low, the middle middle and the smallest high of three sorted columns.
void TakeMedians(const SortedColumns& sorted, std::size_t count, Entry* out) {
  const Entry *low = sorted.low.data(), *middle = sorted.middle.data(), *high = sorted.high.data();
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = Middle(std::max(std::max(low[i], low[i + 1]), low[i + 2]), Middle(middle[i], middle[i + 1], middle[i + 2]),
                    std::min(std::min(high[i], high[i + 1]), high[i + 2]));
  }
}

/// The middle of three weighed 1 : 2^shift - 2 : 1, rounded.
template <int shift>
Entry Weigh(Entry before, Entry middle, Entry after) {
  constexpr int kAll = 1 << shift;
  return static_cast<Entry>((before + (kAll - 2) * middle + after + kAll / 2) >> shift);
}

template <int shift>
Lattice SmoothBy(const Lattice& from, int reach) {
  Lattice smooth(from.columns(), from.rows());
  const auto count = static_cast<std::size_t>(from.columns() + 2 * reach);
  std::vector<Entry> columns(count + 2);
  for (int y = -reach; y < from.rows() + reach; ++y) {
    const int left = -reach - 1;
    const Entry *above = from.Row(y - 1) + left, *row = from.Row(y) + left, *below = from.Row(y + 1) + left;
    for (std::size_t i = 0; i < count + 2; ++i) columns[i] = Weigh<shift>(above[i], row[i], below[i]);
    Entry* out = smooth.Row(y) - reach;
    for (std::size_t i = 0; i < count; ++i) out[i] = Weigh<shift>(columns[i], columns[i + 1], columns[i + 2]);
  }
  return smooth;
}

}  // namespace

Lattice Median3x3(const Lattice& from, int reach) {
  Lattice medians(from.columns(), from.rows());
  const auto count = static_cast<std::size_t>(from.columns() + 2 * reach);
  SortedColumns sorted{std::vector<Entry>(count + 2), std::vector<Entry>(count + 2), std::vector<Entry>(count + 2)};
  for (int y = -reach; y < from.rows() + reach; ++y) {
    const int left = -reach - 1;
    SortColumns({from.Row(y - 1) + left, from.Row(y) + left, from.Row(y + 1) + left}, count + 2, sorted);
    TakeMedians(sorted, count, medians.Row(y) - reach);
  }
  return medians;
}

Lattice Smooth(const Lattice& from, Smoothing smoothing, int reach) {
  return smoothing == Smoothing::kLight ? SmoothBy<3>(from, reach) : SmoothBy<2>(from, reach);
}

}  // namespace drupe
