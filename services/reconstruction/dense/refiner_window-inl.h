// Part of patch_refiner.cpp's vector code: the reference window of a batch of patches, and the sums over it that every
// iteration needs. One lane is one patch.
#if defined(DRUPE_DENSE_REFINER_WINDOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUPE_DENSE_REFINER_WINDOW_INL_H_
#undef DRUPE_DENSE_REFINER_WINDOW_INL_H_
#else
#define DRUPE_DENSE_REFINER_WINDOW_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "reconstruction/dense/patch_refiner.h"

HWY_BEFORE_NAMESPACE();
namespace drupe::dense::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBatch = PatchBatch::kSize;
constexpr int kMaxSide = 2 * RefinerSettings::kMaxHalf + 1;
constexpr float kGrey = 1.0f / 256.0f;  // stored luma to grey levels

using D = hn::CappedTag<float, kBatch>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;

/// The reference window: one row of kBatch lanes a sample.
struct Window {
  HWY_ALIGN float centred[kMaxSide * kMaxSide * kBatch];  // grey levels, offset and linear trend removed
  HWY_ALIGN float gx[kMaxSide * kMaxSide * kBatch];       // grey levels a pixel
  HWY_ALIGN float gy[kMaxSide * kMaxSide * kBatch];
};

/// Sums over the window. J_x = gx (1, du, dv), J_y likewise. Symmetric 3x3: (00, 01, 02, 11, 12, 22).
struct WindowSums {
  HWY_ALIGN float xx[6][kBatch], xy[6][kBatch], yy[6][kBatch];
  HWY_ALIGN float x[6][kBatch], y[6][kBatch];    // sum of gx (1, du, dv)^T (1, du, dv), likewise gy
  HWY_ALIGN float cx[3][kBatch], cy[3][kBatch];  // sum of J times centred
  HWY_ALIGN float variance[kBatch];              // sum of centred^2
};

HWY_INLINE float Samples(int half) {
  return static_cast<float>((2 * half + 1) * (2 * half + 1));
}

/// Sum of du^2 over the window, which is that of dv^2.
HWY_INLINE float SumOfSquares(int half) {
  const int side = 2 * half + 1;
  return static_cast<float>(side * half * (half + 1) * side) / 3.0f;
}

HWY_INLINE void AddTo(float* HWY_RESTRICT sum, V a, V b) {
  const D d;
  hn::Store(hn::MulAdd(a, b, hn::Load(d, sum)), d, sum);
}

/// Grey levels of the reference at whole pixels (u + du, v + dv).
HWY_INLINE V LoadReference(const SampledImage& image, V u, V v, int du, int dv) {
  const D d;
  const DI di;
  const DU dunsigned;
  const auto x = hn::Add(hn::ConvertTo(di, u), hn::Set(di, du));
  const auto y = hn::Add(hn::ConvertTo(di, v), hn::Set(di, dv));
  const auto index = hn::Add(hn::Mul(y, hn::Set(di, image.stride)), x);
  const auto pair = hn::GatherIndex(dunsigned, image.pairs, index);
  const auto low = hn::BitCast(di, hn::And(pair, hn::Set(dunsigned, 0xFFFFu)));
  return hn::Mul(hn::ConvertTo(d, low), hn::Set(d, kGrey));
}

/// Bilinear sample, grey levels.
HWY_INLINE V SampleBilinear(const SampledImage& image, V x, V y) {
  const D d;
  const DI di;
  const DU dunsigned;
  const auto xi = hn::ConvertTo(di, x);  // towards zero; x, y >= 0
  const auto yi = hn::ConvertTo(di, y);
  const V fx = hn::Sub(x, hn::ConvertTo(d, xi)), fy = hn::Sub(y, hn::ConvertTo(d, yi));
  const auto index = hn::Add(hn::Mul(yi, hn::Set(di, image.stride)), xi);
  const auto top = hn::GatherIndex(dunsigned, image.pairs, index);
  const auto bottom = hn::GatherIndex(dunsigned, image.pairs, hn::Add(index, hn::Set(di, image.stride)));
  const auto low = hn::Set(dunsigned, 0xFFFFu);
  const V a = hn::ConvertTo(d, hn::BitCast(di, hn::And(top, low)));
  const V b = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(top)));
  const V c = hn::ConvertTo(d, hn::BitCast(di, hn::And(bottom, low)));
  const V e = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<16>(bottom)));
  const V upper = hn::MulAdd(fx, hn::Sub(b, a), a), lower = hn::MulAdd(fx, hn::Sub(e, c), c);
  return hn::Mul(hn::MulAdd(fy, hn::Sub(lower, upper), upper), hn::Set(d, kGrey));
}

HWY_INLINE void LoadWindow(const SampledImage& image, int half, V u, V v, Window* window) {
  const D d;
  HWY_ALIGN float raw[(kMaxSide + 2) * (kMaxSide + 2) * kBatch];
  const int side = 2 * half + 1, padded = side + 2;
  V sum = hn::Zero(d), sum_u = hn::Zero(d), sum_v = hn::Zero(d);
  for (int j = 0; j < padded; ++j) {
    for (int i = 0; i < padded; ++i) {
      const V value = LoadReference(image, u, v, i - half - 1, j - half - 1);
      hn::Store(value, d, raw + (j * padded + i) * kBatch);
      if (i == 0 || j == 0 || i > side || j > side) continue;
      sum = hn::Add(sum, value);
      sum_u = hn::MulAdd(value, hn::Set(d, static_cast<float>(i - half - 1)), sum_u);
      sum_v = hn::MulAdd(value, hn::Set(d, static_cast<float>(j - half - 1)), sum_v);
    }
  }
  const V mean = hn::Mul(sum, hn::Set(d, 1.0f / static_cast<float>(side * side)));
  const V per_square = hn::Set(d, 1.0f / SumOfSquares(half));
  const V trend_u = hn::Mul(sum_u, per_square), trend_v = hn::Mul(sum_v, per_square);
  const V half_step = hn::Set(d, 0.5f);
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const float* at = raw + ((j + 1) * padded + i + 1) * kBatch;
      const int sample = (j * side + i) * kBatch;
      const V trend = hn::MulAdd(trend_u, hn::Set(d, static_cast<float>(i - half)),
                                 hn::MulAdd(trend_v, hn::Set(d, static_cast<float>(j - half)), mean));
      hn::Store(hn::Sub(hn::Load(d, at), trend), d, window->centred + sample);
      hn::Store(hn::Mul(half_step, hn::Sub(hn::Load(d, at + kBatch), hn::Load(d, at - kBatch))), d,
                window->gx + sample);
      hn::Store(hn::Mul(half_step, hn::Sub(hn::Load(d, at + padded * kBatch), hn::Load(d, at - padded * kBatch))), d,
                window->gy + sample);
    }
  }
}

HWY_INLINE void SumWindow(const Window& window, int half, WindowSums* sums) {
  const D d;
  const int side = 2 * half + 1;
  for (std::size_t i = 0; i < sizeof(WindowSums) / sizeof(float); i += hn::Lanes(d)) {
    hn::Store(hn::Zero(d), d, reinterpret_cast<float*>(sums) + i);
  }
  for (int j = 0; j < side; ++j) {
    const V dv = hn::Set(d, static_cast<float>(j - half));
    for (int i = 0; i < side; ++i) {
      const int sample = (j * side + i) * kBatch;
      const V du = hn::Set(d, static_cast<float>(i - half)), one = hn::Set(d, 1.0f);
      const V c = hn::Load(d, window.centred + sample);
      const V gx = hn::Load(d, window.gx + sample), gy = hn::Load(d, window.gy + sample);
      const V xx = hn::Mul(gx, gx), xy = hn::Mul(gx, gy), yy = hn::Mul(gy, gy);
      const V basis[3] = {one, du, dv};
      for (int p = 0, entry = 0; p < 3; ++p) {
        for (int q = p; q < 3; ++q, ++entry) {
          const V product = hn::Mul(basis[p], basis[q]);
          AddTo(sums->xx[entry], xx, product);
          AddTo(sums->xy[entry], xy, product);
          AddTo(sums->yy[entry], yy, product);
          AddTo(sums->x[entry], gx, product);
          AddTo(sums->y[entry], gy, product);
        }
        AddTo(sums->cx[p], hn::Mul(c, gx), basis[p]);
        AddTo(sums->cy[p], hn::Mul(c, gy), basis[p]);
      }
      AddTo(sums->variance, c, c);
    }
  }
}
}  // namespace drupe::dense::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard
