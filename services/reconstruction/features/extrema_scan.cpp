#include "reconstruction/features/extrema_scan.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruction/features/extrema_scan.cpp"
#include <hwy/foreach_target.h>  // NOLINT: includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace drupe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using FloatTag = hn::CappedTag<float, 16>;
using FloatVec = hn::Vec<FloatTag>;

void Subtract(const float* coarse, const float* fine, int width, float* out) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += lanes) {
    hn::StoreU(hn::Sub(hn::LoadU(d, coarse + x), hn::LoadU(d, fine + x)), d, out + x);
  }
}

struct Bounds {
  FloatVec low, high;
};

HWY_INLINE void Widen(FloatTag d, const float* at, Bounds& bounds) {
  const FloatVec v = hn::LoadU(d, at);
  bounds.low = hn::Min(bounds.low, v);
  bounds.high = hn::Max(bounds.high, v);
}

HWY_INLINE void WidenByRow(FloatTag d, const float* at, Bounds& bounds) {
  Widen(d, at - 1, bounds);
  Widen(d, at, bounds);
  Widen(d, at + 1, bounds);
}

/// Lanes whose value lies outside its 26 neighbours' range. Most places fail on their own row, hence the early ways
/// out.
HWY_INLINE hn::Mask<FloatTag> IsExtremum(FloatTag d, const DogNeighbourhood& rows, int x, float threshold) {
  const FloatVec v = hn::LoadU(d, rows[1][1] + x);
  const FloatVec left = hn::LoadU(d, rows[1][1] + x - 1);
  const FloatVec right = hn::LoadU(d, rows[1][1] + x + 1);
  Bounds bounds{hn::Min(left, right), hn::Max(left, right)};
  const auto outside = [&] { return hn::Or(hn::Gt(v, bounds.high), hn::Lt(v, bounds.low)); };
  const auto strong = hn::Gt(hn::Abs(v), hn::Set(d, threshold));
  auto found = hn::And(outside(), strong);
  if (hn::AllFalse(d, found)) return found;
  WidenByRow(d, rows[1][0] + x, bounds);
  WidenByRow(d, rows[1][2] + x, bounds);
  found = hn::And(outside(), strong);
  if (hn::AllFalse(d, found)) return found;
  for (const int level : {0, 2}) {
    for (int row = 0; row < 3; ++row) WidenByRow(d, rows[level][row] + x, bounds);
  }
  return hn::And(outside(), strong);
}

void FindExtrema(const DogNeighbourhood& rows, int begin, int end, float threshold, std::vector<int>& out) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int x = begin; x < end; x += lanes) {
    const auto found = IsExtremum(d, rows, x, threshold);
    if (hn::AllFalse(d, found)) continue;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, found, bits);
    for (int i = 0; i < lanes && x + i < end; ++i) {
      if ((bits[i / 8] >> (i % 8)) & 1) out.push_back(x + i);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace drupe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drupe {

HWY_EXPORT(Subtract);
HWY_EXPORT(FindExtrema);

void SubtractRows(const float* coarse, const float* fine, int width, float* out) {
  HWY_DYNAMIC_DISPATCH(Subtract)(coarse, fine, width, out);
}

void FindExtremaInRow(const DogNeighbourhood& rows, int begin, int end, float threshold, std::vector<int>& out) {
  HWY_DYNAMIC_DISPATCH(FindExtrema)(rows, begin, end, threshold, out);
}

}  // namespace drupe
#endif
