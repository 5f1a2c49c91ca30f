#include "reconstruction/features/blur.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruction/features/blur.cpp"
#include <hwy/foreach_target.h>  // NOLINT: includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace drupe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// At most 64 bytes, what Image pads its rows to, so that whole vectors may be written at a row's end.
using FloatTag = hn::CappedTag<float, 16>;
using FloatVec = hn::Vec<FloatTag>;

inline FloatVec LoadFloats(FloatTag d, const float* from) {
  return hn::LoadU(d, from);
}
inline FloatVec LoadFloats(FloatTag d, const std::uint8_t* from) {
  const hn::Rebind<std::uint8_t, FloatTag> d8;
  const hn::Rebind<std::int32_t, FloatTag> d32;
  return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, from)));
}

/// Weighted sum over `radius` pairs of values on both sides of a centre, for kUnroll vectors at once. `before(k)` and
/// `after(k)` give the addresses k steps away for the first vector.
template <int kUnroll, typename T, typename Before, typename After>
HWY_INLINE void SymmetricSum(FloatTag d, const BlurKernel& kernel, const T* centre, const Before& before,
                             const After& after, float* out) {
  const std::size_t lanes = hn::Lanes(d);
  const auto w0 = hn::Set(d, kernel.weights[0]);
  FloatVec sum[kUnroll];
  for (int j = 0; j < kUnroll; ++j) sum[j] = hn::Mul(w0, LoadFloats(d, centre + j * lanes));
  for (int k = 1; k <= kernel.radius(); ++k) {
    const auto w = hn::Set(d, kernel.weights[k]);
    const T* a = before(k);
    const T* b = after(k);
    for (int j = 0; j < kUnroll; ++j) {
      sum[j] = hn::MulAdd(w, hn::Add(LoadFloats(d, a + j * lanes), LoadFloats(d, b + j * lanes)), sum[j]);
    }
  }
  for (int j = 0; j < kUnroll; ++j) hn::StoreU(sum[j], d, out + j * lanes);
}

/// out[x] for x in [0, width), rounded up to a vector.
template <typename T, typename Before, typename After>
HWY_INLINE void SumAlongRow(const BlurKernel& kernel, int width, const T* centre, const Before& before,
                            const After& after, float* out) {
  const FloatTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  const auto at = [&x](const auto& side) { return [&side, &x](int k) { return side(k) + x; }; };
  for (; x + 4 * lanes <= width; x += 4 * lanes) {
    SymmetricSum<4>(d, kernel, centre + x, at(before), at(after), out + x);
  }
  for (; x < width; x += lanes) SymmetricSum<1>(d, kernel, centre + x, at(before), at(after), out + x);
}

template <typename T>
void BlurRowsOf(const Image<T>& source, const BlurKernel& kernel, int row_begin, int row_end, FloatImage& target) {
  const int width = source.width();
  const int radius = kernel.radius();
  const int last_row = source.height() - 1;
  const int margin = (radius + 15) / 16 * 16;  // keeps the middle aligned
  FloatImage line(width + 2 * margin + 16, 1);
  float* middle = line.Row(0) + margin;
  for (int y = row_begin; y < row_end; ++y) {
    SumAlongRow(
        kernel, width, source.Row(y), [&](int k) { return source.Row(std::max(y - k, 0)); },
        [&](int k) { return source.Row(std::min(y + k, last_row)); }, middle);
    std::fill(middle - radius, middle, middle[0]);
    std::fill(middle + width, middle + width + radius, middle[width - 1]);
    SumAlongRow(
        kernel, width, middle, [&](int k) { return middle - k; }, [&](int k) { return middle + k; }, target.Row(y));
  }
}

void BlurRowsGray(const GrayImage& source, const BlurKernel& kernel, int row_begin, int row_end, FloatImage& target) {
  BlurRowsOf(source, kernel, row_begin, row_end, target);
}
void BlurRowsFloat(const FloatImage& source, const BlurKernel& kernel, int row_begin, int row_end, FloatImage& target) {
  BlurRowsOf(source, kernel, row_begin, row_end, target);
}

}  // namespace HWY_NAMESPACE
}  // namespace drupe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drupe {

HWY_EXPORT(BlurRowsGray);
HWY_EXPORT(BlurRowsFloat);

BlurKernel GaussianKernel(double sigma) {
  // Beyond 3.5 sigma lie 0.05 % of the weight.
  const int radius = std::max(1, static_cast<int>(std::ceil(3.5 * sigma)));
  std::vector<double> weights(radius + 1);
  double sum = 0;
  for (int k = 0; k <= radius; ++k) {
    weights[k] = std::exp(-0.5 * k * k / (sigma * sigma));
    sum += k == 0 ? weights[k] : 2 * weights[k];
  }
  BlurKernel kernel;
  for (const double weight : weights) kernel.weights.push_back(static_cast<float>(weight / sum));
  return kernel;
}

void BlurRows(const GrayImage& source, const BlurKernel& kernel, int row_begin, int row_end, FloatImage& target) {
  HWY_DYNAMIC_DISPATCH(BlurRowsGray)(source, kernel, row_begin, row_end, target);
}

void BlurRows(const FloatImage& source, const BlurKernel& kernel, int row_begin, int row_end, FloatImage& target) {
  HWY_DYNAMIC_DISPATCH(BlurRowsFloat)(source, kernel, row_begin, row_end, target);
}

}  // namespace drupe
#endif
