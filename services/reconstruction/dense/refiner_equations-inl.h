// Part of patch_refiner.cpp's vector code: the normal equations of a plane and their solution. One lane is one patch.
#if defined(DRUPE_DENSE_REFINER_EQUATIONS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUPE_DENSE_REFINER_EQUATIONS_INL_H_
#undef DRUPE_DENSE_REFINER_EQUATIONS_INL_H_
#else
#define DRUPE_DENSE_REFINER_EQUATIONS_INL_H_
#endif

#include <hwy/highway.h>

#include "reconstruction/dense/refiner_warp-inl.h"
#include "reconstruction/dense/refiner_window-inl.h"

HWY_BEFORE_NAMESPACE();
namespace drupe::dense::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kNoiseVariance = 0.25f;    // least variance of a residual, grey levels squared
constexpr float kLeastSteeringNcc = 0.2f;  // a neighbour below this does not steer the fit

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
}  // namespace drupe::dense::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // include guard
