// Part of patch_refiner.cpp's vector code: how a plane maps the reference window into a neighbour, and the sums over
// the samples there. One lane is one patch.
#if defined(DRUPE_DENSE_REFINER_WARP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUPE_DENSE_REFINER_WARP_INL_H_
#undef DRUPE_DENSE_REFINER_WARP_INL_H_
#else
#define DRUPE_DENSE_REFINER_WARP_INL_H_
#endif

#include <hwy/highway.h>

#include "reconstruction/dense/patch_refiner.h"
#include "reconstruction/dense/refiner_window-inl.h"

HWY_BEFORE_NAMESPACE();
namespace drupe::dense::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kLeastScale = 0.2f, kLargestScale = 5.0f;  // of a warp's area

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
}  // namespace drupe::dense::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard
