// The vector code of patch_refiner.cpp, compiled once for every instruction set. One lane is one patch.
#if defined(DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_
#undef DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_
#else
#define DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_
#endif

#include <cstdint>

#include <hwy/highway.h>

#include "reconstruction/dense/patch_refiner.h"

HWY_BEFORE_NAMESPACE();
namespace drupe::dense::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBatch = PatchBatch::kSize;
constexpr int kMaxSide = 2 * RefinerSettings::kMaxHalf + 1;
constexpr float kGrey = 1.0f / 256.0f;                     // stored luma to grey levels
constexpr float kNoiseVariance = 0.25f;                    // least variance of a residual, grey levels squared
constexpr float kLeastSteeringNcc = 0.2f;                  // a neighbour below this does not steer the fit
constexpr float kLeastScale = 0.2f, kLargestScale = 5.0f;  // of a warp's area
constexpr float kLargestStep = 1.0f, kLargestSlopeStep = 0.2f, kConverged = 0.01f;

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

/// The plane's homography into a neighbour about the patch's centre: (p + i du + j dv) homogeneous.
struct Warp {
  V p[3], i[3], j[3];
  V ex, ey;  ///< shift of the reference pixel that equals a change of w by one frame unit
  M inside;  ///< the window lies in the picture and is not scaled beyond reason
};

HWY_INLINE Warp MakeWarp(const NeighbourWarp& n, float unit, int half, V u, V v, V w, V wu, V wv) {
  const D d;
  Warp warp;
  for (int r = 0; r < 3; ++r) {
    const V b = hn::Set(d, n.b[r]);
    const V a0 = hn::Set(d, n.a[3 * r]), a1 = hn::Set(d, n.a[3 * r + 1]);
    warp.p[r] = hn::MulAdd(a0, u, hn::MulAdd(a1, v, hn::MulAdd(b, w, hn::Set(d, n.a[3 * r + 2]))));
    warp.i[r] = hn::MulAdd(b, wu, a0);
    warp.j[r] = hn::MulAdd(b, wv, a1);
  }
  const V inverse = hn::Div(hn::Set(d, 1.0f), warp.p[2]);
  const V x = hn::Mul(warp.p[0], inverse), y = hn::Mul(warp.p[1], inverse);
  const V m00 = hn::Mul(inverse, hn::NegMulAdd(x, warp.i[2], warp.i[0]));
  const V m01 = hn::Mul(inverse, hn::NegMulAdd(x, warp.j[2], warp.j[0]));
  const V m10 = hn::Mul(inverse, hn::NegMulAdd(y, warp.i[2], warp.i[1]));
  const V m11 = hn::Mul(inverse, hn::NegMulAdd(y, warp.j[2], warp.j[1]));
  const V scale = hn::Mul(inverse, hn::Set(d, unit));
  const V bz = hn::Set(d, n.b[2]);
  const V dx = hn::Mul(scale, hn::NegMulAdd(x, bz, hn::Set(d, n.b[0])));
  const V dy = hn::Mul(scale, hn::NegMulAdd(y, bz, hn::Set(d, n.b[1])));
  const V det = hn::NegMulAdd(m01, m10, hn::Mul(m00, m11));
  const V det_inverse = hn::Div(hn::Set(d, 1.0f), det);
  warp.ex = hn::Mul(det_inverse, hn::NegMulAdd(m01, dy, hn::Mul(m11, dx)));
  warp.ey = hn::Mul(det_inverse, hn::NegMulAdd(m10, dx, hn::Mul(m00, dy)));
  // Reach of the window from its centre in the neighbour, with a margin for perspective.
  const V reach = hn::Set(d, 1.05f * static_cast<float>(half));
  const V reach_x = hn::MulAdd(reach, hn::Add(hn::Abs(m00), hn::Abs(m01)), hn::Set(d, 1.0f));
  const V reach_y = hn::MulAdd(reach, hn::Add(hn::Abs(m10), hn::Abs(m11)), hn::Set(d, 1.0f));
  const V right = hn::Set(d, static_cast<float>(n.image.width - 2)),
          bottom = hn::Set(d, static_cast<float>(n.image.height - 2));
  M inside = hn::And(hn::Ge(hn::Sub(x, reach_x), hn::Zero(d)), hn::Le(hn::Add(x, reach_x), right));
  inside = hn::And(inside, hn::And(hn::Ge(hn::Sub(y, reach_y), hn::Zero(d)), hn::Le(hn::Add(y, reach_y), bottom)));
  inside = hn::And(inside, hn::And(hn::Ge(det, hn::Set(d, kLeastScale)), hn::Le(det, hn::Set(d, kLargestScale))));
  warp.inside = hn::And(inside, hn::Gt(warp.p[2], hn::Zero(d)));
  // Lanes outside read the first pixel.
  for (int r = 0; r < 3; ++r) {
    warp.p[r] = hn::IfThenElse(warp.inside, warp.p[r], hn::Set(d, r == 2 ? 1.0f : 0.0f));
    warp.i[r] = hn::IfThenElseZero(warp.inside, warp.i[r]);
    warp.j[r] = hn::IfThenElseZero(warp.inside, warp.j[r]);
  }
  return warp;
}

/// Sums over a neighbour's samples t. Without slopes only what NCC needs is filled.
struct NeighbourSums {
  V t, tu, tv;      // t (1, du, dv)
  V tt, ct;         // t^2, centred t
  V tx0, tx1, tx2;  // J_x t
  V ty0, ty1, ty2;  // J_y t
};

template <bool kSlopes>
HWY_INLINE NeighbourSums SumNeighbour(const SampledImage& image, const Window& window, int half, const Warp& warp) {
  const D d;
  const V zero = hn::Zero(d);
  NeighbourSums s{zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
  const int side = 2 * half + 1;
  const V origin = SampleBilinear(image, hn::Div(warp.p[0], warp.p[2]), hn::Div(warp.p[1], warp.p[2]));
  for (int j = 0; j < side; ++j) {
    const V dv = hn::Set(d, static_cast<float>(j - half));
    const V row0 = hn::MulAdd(warp.j[0], dv, warp.p[0]);
    const V row1 = hn::MulAdd(warp.j[1], dv, warp.p[1]);
    const V row2 = hn::MulAdd(warp.j[2], dv, warp.p[2]);
    for (int i = 0; i < side; ++i) {
      const V du = hn::Set(d, static_cast<float>(i - half));
      const V inverse = hn::Div(hn::Set(d, 1.0f), hn::MulAdd(warp.i[2], du, row2));
      const V x = hn::Mul(hn::MulAdd(warp.i[0], du, row0), inverse);
      const V y = hn::Mul(hn::MulAdd(warp.i[1], du, row1), inverse);
      const V t = hn::Sub(SampleBilinear(image, x, y), origin);  // small numbers keep the sums exact
      const int sample = (j * side + i) * kBatch;
      s.t = hn::Add(s.t, t);
      s.tu = hn::MulAdd(t, du, s.tu);
      s.tv = hn::MulAdd(t, dv, s.tv);
      s.tt = hn::MulAdd(t, t, s.tt);
      s.ct = hn::MulAdd(hn::Load(d, window.centred + sample), t, s.ct);
      if constexpr (kSlopes) {
        const V tx = hn::Mul(t, hn::Load(d, window.gx + sample)), ty = hn::Mul(t, hn::Load(d, window.gy + sample));
        s.tx0 = hn::Add(s.tx0, tx);
        s.tx1 = hn::MulAdd(tx, du, s.tx1);
        s.tx2 = hn::MulAdd(tx, dv, s.tx2);
        s.ty0 = hn::Add(s.ty0, ty);
        s.ty1 = hn::MulAdd(ty, du, s.ty1);
        s.ty2 = hn::MulAdd(ty, dv, s.ty2);
      }
    }
  }
  return s;
}

/// Normalised cross-correlation from the sums; `variance` is the sum of the centred reference squared.
HWY_INLINE V Ncc(const NeighbourSums& s, V variance, int half) {
  const D d;
  const V per_square = hn::Set(d, 1.0f / SumOfSquares(half));
  V spread = hn::NegMulAdd(hn::Mul(s.t, s.t), hn::Set(d, 1.0f / Samples(half)), s.tt);
  spread = hn::NegMulAdd(hn::MulAdd(s.tu, s.tu, hn::Mul(s.tv, s.tv)), per_square, spread);
  const V product = hn::Max(hn::Mul(spread, variance), hn::Set(d, 1e-6f));
  return hn::Div(s.ct, hn::Sqrt(product));
}

/// The normal equations of w, wu, wv in frame units.
struct Equations {
  V h00, h01, h02, h11, h12, h22, g0, g1, g2;
};

/// Adds one neighbour: its Jacobian is ex J_x + ey J_y, less the parts along offset, linear trend and gain.
HWY_INLINE void AddNeighbour(const WindowSums& w, const NeighbourSums& s, const Warp& warp, M use, int half,
                             Equations* eq) {
  const D d;
  const V variance = hn::Max(hn::Load(d, w.variance), hn::Set(d, 1e-3f));
  const V ncc = hn::Min(Ncc(s, variance, half), hn::Set(d, 0.9999f));
  use = hn::And(use, hn::Gt(ncc, hn::Set(d, kLeastSteeringNcc)));
  if (hn::AllFalse(d, use)) return;
  const V inverse_samples = hn::Set(d, 1.0f / Samples(half)), per_square = hn::Set(d, 1.0f / SumOfSquares(half));
  const V inverse_variance = hn::Div(hn::Set(d, 1.0f), variance);
  const V ncc2 = hn::Mul(ncc, ncc);
  const V residual = hn::Div(hn::Mul(hn::Mul(variance, inverse_samples), hn::Sub(hn::Set(d, 1.0f), ncc2)), ncc2);
  const V weight = hn::IfThenElseZero(use, hn::Div(hn::Set(d, 1.0f), hn::Add(residual, hn::Set(d, kNoiseVariance))));
  const V gain = hn::IfThenElse(use, hn::Mul(s.ct, inverse_variance), hn::Set(d, 1.0f));
  const V weight_over_gain = hn::Div(weight, gain);
  const V exx = hn::Mul(warp.ex, warp.ex), eyy = hn::Mul(warp.ey, warp.ey);
  const V exy = hn::Mul(hn::Set(d, 2.0f), hn::Mul(warp.ex, warp.ey));
  const V tx[3] = {s.tx0, s.tx1, s.tx2}, ty[3] = {s.ty0, s.ty1, s.ty2};
  V offset[3], trend_u[3], trend_v[3], gain_part[3];
  V* h[6] = {&eq->h00, &eq->h01, &eq->h02, &eq->h11, &eq->h12, &eq->h22};
  V* g[3] = {&eq->g0, &eq->g1, &eq->g2};
  for (int p = 0; p < 3; ++p) {
    // Row p of sum J (1, du, dv): entries 0 1 2, 1 3 4, 2 4 5 of the symmetric matrix.
    constexpr int kRow[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    const auto along = [&](int entry) HWY_ATTR {
      return hn::MulAdd(warp.ex, hn::Load(d, w.x[entry]), hn::Mul(warp.ey, hn::Load(d, w.y[entry])));
    };
    offset[p] = along(kRow[p][0]);
    trend_u[p] = along(kRow[p][1]);
    trend_v[p] = along(kRow[p][2]);
    gain_part[p] = hn::MulAdd(warp.ex, hn::Load(d, w.cx[p]), hn::Mul(warp.ey, hn::Load(d, w.cy[p])));
    V value = hn::MulAdd(warp.ex, tx[p], hn::Mul(warp.ey, ty[p]));
    value = hn::NegMulAdd(hn::Mul(offset[p], inverse_samples), s.t, value);
    value = hn::NegMulAdd(per_square, hn::MulAdd(trend_u[p], s.tu, hn::Mul(trend_v[p], s.tv)), value);
    value = hn::NegMulAdd(hn::Mul(gain_part[p], inverse_variance), s.ct, value);
    *g[p] = hn::MulAdd(weight_over_gain, value, *g[p]);
  }
  for (int p = 0, entry = 0; p < 3; ++p) {
    for (int q = p; q < 3; ++q, ++entry) {
      V value = hn::Mul(exx, hn::Load(d, w.xx[entry]));
      value = hn::MulAdd(exy, hn::Load(d, w.xy[entry]), value);
      value = hn::MulAdd(eyy, hn::Load(d, w.yy[entry]), value);
      value = hn::NegMulAdd(hn::Mul(offset[p], inverse_samples), offset[q], value);
      value = hn::NegMulAdd(per_square, hn::MulAdd(trend_u[p], trend_u[q], hn::Mul(trend_v[p], trend_v[q])), value);
      value = hn::NegMulAdd(hn::Mul(gain_part[p], inverse_variance), gain_part[q], value);
      *h[entry] = hn::MulAdd(weight, value, *h[entry]);
    }
  }
}

/// The solution of the symmetric equations by cofactors, and the variance of the first unknown.
HWY_INLINE void Solve(const Equations& e, V* s0, V* s1, V* s2, V* variance0) {
  const D d;
  const V c00 = hn::NegMulAdd(e.h12, e.h12, hn::Mul(e.h11, e.h22));
  const V c01 = hn::NegMulAdd(e.h01, e.h22, hn::Mul(e.h02, e.h12));
  const V c02 = hn::NegMulAdd(e.h02, e.h11, hn::Mul(e.h01, e.h12));
  const V c11 = hn::NegMulAdd(e.h02, e.h02, hn::Mul(e.h00, e.h22));
  const V c12 = hn::NegMulAdd(e.h00, e.h12, hn::Mul(e.h01, e.h02));
  const V c22 = hn::NegMulAdd(e.h01, e.h01, hn::Mul(e.h00, e.h11));
  const V det = hn::MulAdd(e.h00, c00, hn::MulAdd(e.h01, c01, hn::Mul(e.h02, c02)));
  const V inverse = hn::Div(hn::Set(d, 1.0f), hn::Max(det, hn::Set(d, 1e-20f)));
  *s0 = hn::Mul(inverse, hn::MulAdd(c00, e.g0, hn::MulAdd(c01, e.g1, hn::Mul(c02, e.g2))));
  *s1 = hn::Mul(inverse, hn::MulAdd(c01, e.g0, hn::MulAdd(c11, e.g1, hn::Mul(c12, e.g2))));
  *s2 = hn::Mul(inverse, hn::MulAdd(c02, e.g0, hn::MulAdd(c12, e.g1, hn::Mul(c22, e.g2))));
  *variance0 = hn::Mul(inverse, c00);
}

HWY_INLINE V Clamped(V value, float limit) {
  const D d;
  return hn::Min(hn::Max(value, hn::Set(d, -limit)), hn::Set(d, limit));
}

HWY_INLINE M UsesView(const PatchBatch& batch, int lane, int neighbour) {
  const D d;
  const DU du;
  const auto bits = hn::Load(du, batch.views.data() + lane);
  const auto bit = hn::Set(du, std::uint32_t{1} << neighbour);
  return hn::RebindMask(d, hn::Ne(hn::And(bits, bit), hn::Zero(du)));
}

/// The plane of each lane, in frame units.
struct Plane {
  V w, wu, wv;
};

/// The normal equations at `at`, with the prior about `prior`.
HWY_INLINE Equations BuildEquations(const RefinerFrame& frame, const RefinerSettings& settings, const PatchBatch& batch,
                                    int lane, const Window& window, const WindowSums& sums, const Plane& at,
                                    const Plane& prior) {
  const D d;
  const V u = hn::Load(d, batch.u.data() + lane), v = hn::Load(d, batch.v.data() + lane);
  const V unit = hn::Set(d, frame.unit), zero = hn::Zero(d);
  const V depth_sigma = hn::Load(d, batch.depth_sigma.data() + lane);
  const V depth = hn::Div(hn::Set(d, 1.0f), hn::Mul(depth_sigma, depth_sigma));
  const V slope = hn::Set(d, 1.0f / (settings.slope_sigma * settings.slope_sigma));
  Equations eq{depth,
               zero,
               zero,
               slope,
               zero,
               slope,
               hn::Mul(depth, hn::Sub(at.w, prior.w)),
               hn::Mul(slope, hn::Sub(at.wu, prior.wu)),
               hn::Mul(slope, hn::Sub(at.wv, prior.wv))};
  for (std::size_t k = 0; k < frame.neighbours.size(); ++k) {
    M use = UsesView(batch, lane, static_cast<int>(k));
    if (hn::AllFalse(d, use)) continue;
    const Warp warp = MakeWarp(frame.neighbours[k], frame.unit, settings.half, u, v, hn::Mul(at.w, unit),
                               hn::Mul(at.wu, unit), hn::Mul(at.wv, unit));
    use = hn::And(use, warp.inside);
    if (hn::AllFalse(d, use)) continue;
    const NeighbourSums s = SumNeighbour<true>(frame.neighbours[k].image, window, settings.half, warp);
    AddNeighbour(sums, s, warp, use, settings.half, &eq);
  }
  return eq;
}

/// Fills views and ncc at the refined plane.
HWY_INLINE void Judge(const RefinerFrame& frame, const RefinerSettings& settings, int lane, const Window& window,
                      const WindowSums& sums, const Plane& at, PatchBatch* batch) {
  const D d;
  const DU du;
  const V u = hn::Load(d, batch->u.data() + lane), v = hn::Load(d, batch->v.data() + lane);
  const V unit = hn::Set(d, frame.unit);
  V total = hn::Zero(d), count = hn::Zero(d);
  auto agreeing = hn::Zero(du);
  for (std::size_t k = 0; k < frame.neighbours.size(); ++k) {
    M use = UsesView(*batch, lane, static_cast<int>(k));
    if (hn::AllFalse(d, use)) continue;
    const Warp warp = MakeWarp(frame.neighbours[k], frame.unit, settings.half, u, v, hn::Mul(at.w, unit),
                               hn::Mul(at.wu, unit), hn::Mul(at.wv, unit));
    use = hn::And(use, warp.inside);
    if (hn::AllFalse(d, use)) continue;
    const NeighbourSums s = SumNeighbour<false>(frame.neighbours[k].image, window, settings.half, warp);
    const V ncc = Ncc(s, hn::Load(d, sums.variance), settings.half);
    use = hn::And(use, hn::Ge(ncc, hn::Set(d, settings.least_view_ncc)));
    total = hn::Add(total, hn::IfThenElseZero(use, ncc));
    count = hn::Add(count, hn::IfThenElseZero(use, hn::Set(d, 1.0f)));
    agreeing = hn::Or(agreeing, hn::IfThenElseZero(hn::RebindMask(du, use), hn::Set(du, std::uint32_t{1} << k)));
  }
  hn::Store(hn::Div(total, hn::Max(count, hn::Set(d, 1.0f))), d, batch->ncc.data() + lane);
  hn::Store(agreeing, du, batch->views.data() + lane);
}

HWY_INLINE void RefineLanes(const RefinerFrame& frame, const RefinerSettings& settings, int lane, Window* window,
                            WindowSums* sums, PatchBatch* batch) {
  const D d;
  const V unit = hn::Set(d, frame.unit), per_unit = hn::Set(d, 1.0f / frame.unit);
  const V u = hn::Load(d, batch->u.data() + lane), v = hn::Load(d, batch->v.data() + lane);
  LoadWindow(frame.reference, settings.half, u, v, window);
  SumWindow(*window, settings.half, sums);
  const Plane prior{hn::Mul(per_unit, hn::Load(d, batch->w.data() + lane)),
                    hn::Mul(per_unit, hn::Load(d, batch->wu.data() + lane)),
                    hn::Mul(per_unit, hn::Load(d, batch->wv.data() + lane))};
  Plane at = prior;
  V variance = hn::Zero(d);
  M active = hn::Eq(u, u);
  for (int iteration = 0; iteration < settings.iterations && !hn::AllFalse(d, active); ++iteration) {
    const Equations eq = BuildEquations(frame, settings, *batch, lane, *window, *sums, at, prior);
    V step0, step1, step2, variance0;
    Solve(eq, &step0, &step1, &step2, &variance0);
    variance = hn::IfThenElse(active, variance0, variance);
    at.w = hn::Sub(at.w, hn::IfThenElseZero(active, Clamped(step0, kLargestStep)));
    at.wu = hn::Sub(at.wu, hn::IfThenElseZero(active, Clamped(step1, kLargestSlopeStep)));
    at.wv = hn::Sub(at.wv, hn::IfThenElseZero(active, Clamped(step2, kLargestSlopeStep)));
    active = hn::And(active, hn::Gt(hn::Abs(step0), hn::Set(d, kConverged)));
  }
  Judge(frame, settings, lane, *window, *sums, at, batch);
  hn::Store(hn::Mul(at.w, unit), d, batch->w.data() + lane);
  hn::Store(hn::Mul(at.wu, unit), d, batch->wu.data() + lane);
  hn::Store(hn::Mul(at.wv, unit), d, batch->wv.data() + lane);
  hn::Store(hn::Sqrt(hn::Max(variance, hn::Zero(d))), d, batch->sigma.data() + lane);
  hn::Store(hn::Abs(hn::Sub(at.w, prior.w)), d, batch->moved.data() + lane);
}

void RefineBatch(const RefinerFrame& frame, const RefinerSettings& settings, PatchBatch* batch) {
  Window window;
  WindowSums sums;
  for (std::size_t lane = 0; lane < kBatch; lane += hn::Lanes(D())) {
    RefineLanes(frame, settings, static_cast<int>(lane), &window, &sums, batch);
  }
}

}  // namespace drupe::dense::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard
