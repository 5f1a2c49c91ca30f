// The vector code of patch_refiner.cpp, compiled once for every instruction set: the iterations of a batch of patches.
// One lane is one patch.
#if defined(DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_
#undef DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_
#else
#define DRUPE_DENSE_PATCH_REFINER_LANES_INL_H_
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "reconstruction/dense/patch_refiner.h"
#include "reconstruction/dense/refiner_equations-inl.h"
#include "reconstruction/dense/refiner_warp-inl.h"
#include "reconstruction/dense/refiner_window-inl.h"

HWY_BEFORE_NAMESPACE();
namespace drupe::dense::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kLargestStep = 1.0f, kLargestSlopeStep = 0.2f, kConverged = 0.01f;

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
