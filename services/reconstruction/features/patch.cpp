#include "reconstruction/features/patch.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruction/features/patch.cpp"
#include <hwy/foreach_target.h>  // NOLINT: includes this file once per instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace drupe {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
// Both grids are multiples of 8 wide.
using FloatTag = hn::CappedTag<float, 8>;
using FloatVec = hn::Vec<FloatTag>;
using IntTag = hn::RebindToSigned<FloatTag>;

/// Row length of the samples: the grid, a frame of one sample for the differences, rounded up.
constexpr int SampleStride(int grid) {
  return (grid + 2 + 7) / 8 * 8;
}

template <int kGrid>
struct Samples {
  alignas(64) float values[(kGrid + 2) * SampleStride(kGrid) + 16];
  const float* At(int x, int y) const { return values + (y + 1) * SampleStride(kGrid) + x + 1; }
};

/// Bilinear values of the picture at (x, y); outside it goes on with its border.
HWY_INLINE FloatVec Interpolate(FloatTag d, const FloatImage& image, FloatVec x, FloatVec y) {
  const IntTag di;
  const FloatVec zero = hn::Zero(d);
  x = hn::Max(zero, hn::Min(x, hn::Set(d, static_cast<float>(image.width()) - 1.001f)));
  y = hn::Max(zero, hn::Min(y, hn::Set(d, static_cast<float>(image.height()) - 1.001f)));
  const auto xi = hn::ConvertTo(di, x);
  const auto yi = hn::ConvertTo(di, y);
  const FloatVec fx = hn::Sub(x, hn::ConvertTo(d, xi));
  const FloatVec fy = hn::Sub(y, hn::ConvertTo(d, yi));
  const auto index = hn::Add(hn::Mul(yi, hn::Set(di, static_cast<int>(image.stride()))), xi);
  const float* top = image.Row(0);
  const float* bottom = top + image.stride();
  const FloatVec a = hn::GatherIndex(d, top, index), b = hn::GatherIndex(d, top + 1, index);
  const FloatVec c = hn::GatherIndex(d, bottom, index), e = hn::GatherIndex(d, bottom + 1, index);
  const FloatVec upper = hn::MulAdd(fx, hn::Sub(b, a), a);
  const FloatVec lower = hn::MulAdd(fx, hn::Sub(e, c), c);
  return hn::MulAdd(fy, hn::Sub(lower, upper), upper);
}

template <int kGrid>
void SampleGrid(const FloatImage& image, const PatchFrame& frame, Samples<kGrid>& out) {
  const FloatTag d;
  constexpr int kStride = SampleStride(kGrid);
  constexpr float kMiddle = (kGrid + 1) / 2.0f;  // of the grid with its frame
  const FloatVec along_x = hn::Set(d, frame.step * frame.cosine);
  const FloatVec along_y = hn::Set(d, frame.step * frame.sine);
  for (int j = 0; j < kGrid + 2; ++j) {
    const float v = frame.step * (static_cast<float>(j) - kMiddle);
    const FloatVec x0 = hn::Set(d, frame.x - v * frame.sine);
    const FloatVec y0 = hn::Set(d, frame.y + v * frame.cosine);
    for (int i = 0; i < kStride; i += static_cast<int>(hn::Lanes(d))) {
      const FloatVec u = hn::Iota(d, static_cast<float>(i) - kMiddle);
      const FloatVec values = Interpolate(d, image, hn::MulAdd(u, along_x, x0), hn::MulAdd(u, along_y, y0));
      hn::Store(values, d, out.values + j * kStride + i);
    }
  }
}

/// atan2(y, x) as a share of `full_turn`, in [0, full_turn]; the polynomial (minimax, odd, degree 9) errs by 1e-5 rad.
HWY_INLINE FloatVec AngleOf(FloatTag d, FloatVec y, FloatVec x, float full_turn) {
  const FloatVec ax = hn::Abs(x), ay = hn::Abs(y);
  const FloatVec large = hn::Max(hn::Max(ax, ay), hn::Set(d, 1e-20f));
  const FloatVec t = hn::Div(hn::Min(ax, ay), large);
  const FloatVec t2 = hn::Mul(t, t);
  FloatVec p = hn::Set(d, 0.0208351f);
  p = hn::MulAdd(p, t2, hn::Set(d, -0.0851330f));
  p = hn::MulAdd(p, t2, hn::Set(d, 0.1801410f));
  p = hn::MulAdd(p, t2, hn::Set(d, -0.3302995f));
  p = hn::MulAdd(p, t2, hn::Set(d, 0.9998660f));
  const float per_radian = full_turn / 6.283185307f;
  FloatVec angle = hn::Mul(hn::Mul(p, t), hn::Set(d, per_radian));
  angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, 0.25f * full_turn), angle), angle);
  angle = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, 0.5f * full_turn), angle), angle);
  return hn::IfThenElse(hn::Lt(y, hn::Zero(d)), hn::Sub(hn::Set(d, full_turn), angle), angle);
}

/// Magnitude and angle of the gradient at the samples from `at` on.
HWY_INLINE void PolarGradient(FloatTag d, const float* at, int stride, float full_turn, FloatVec& magnitude,
                              FloatVec& angle) {
  const FloatVec dx = hn::Sub(hn::LoadU(d, at + 1), hn::LoadU(d, at - 1));
  const FloatVec dy = hn::Sub(hn::LoadU(d, at + stride), hn::LoadU(d, at - stride));
  magnitude = hn::Sqrt(hn::MulAdd(dx, dx, hn::Mul(dy, dy)));
  angle = AngleOf(d, dy, dx, full_turn);
}

void OrientationPatch(const FloatImage& image, const PatchFrame& frame, PatchGradient<kOrientationGrid>& out) {
  const FloatTag d;
  Samples<kOrientationGrid> samples;
  SampleGrid<kOrientationGrid>(image, frame, samples);
  for (int y = 0; y < kOrientationGrid; ++y) {
    for (int x = 0; x < kOrientationGrid; x += static_cast<int>(hn::Lanes(d))) {
      FloatVec magnitude, angle;
      PolarGradient(d, samples.At(x, y), SampleStride(kOrientationGrid), 36, magnitude, angle);
      hn::Store(magnitude, d, out.magnitude.data() + y * kOrientationGrid + x);
      hn::Store(angle, d, out.angle.data() + y * kOrientationGrid + x);
    }
  }
}

/// The fixed weights of the descriptor's grid.
struct GridWeights {
  alignas(64) float window[kDescriptorGrid];   ///< Gaussian of half the descriptor's width, one factor per axis
  alignas(64) float cell[4][kDescriptorGrid];  ///< share of cell c in sample i, linear
  int first_cell[kDescriptorGrid];             ///< the lower of the (up to) two cells that share row i

  GridWeights() {
    constexpr float kCell = kDescriptorGrid / 5.0f;  // samples per cell: the grid is five cells wide
    for (int i = 0; i < kDescriptorGrid; ++i) {
      const float from_middle = (static_cast<float>(i) - (kDescriptorGrid - 1) / 2.0f) / kCell;  // cells
      window[i] = std::exp(-from_middle * from_middle / (2 * 2 * 2));
      for (int c = 0; c < 4; ++c) cell[c][i] = std::max(0.0f, 1 - std::abs(from_middle + 1.5f - static_cast<float>(c)));
      first_cell[i] = std::clamp(static_cast<int>(std::floor(from_middle + 1.5f)), 0, 2);
    }
  }
};

/// Sums over rows: for cell row c and direction o, a line of the grid's width.
struct RowSums {
  alignas(64) float line[4][8][kDescriptorGrid] = {};
};

/// Adds the samples of row y from x on to the two cell rows that share them.
HWY_INLINE void AddToRowSums(FloatTag d, const GridWeights& weights, int x, int y, FloatVec magnitude, FloatVec angle,
                             RowSums& sums) {
  const int c = weights.first_cell[y];
  const FloatVec upper_weight = hn::Set(d, weights.cell[c][y]);
  const FloatVec lower_weight = hn::Set(d, weights.cell[c + 1][y]);
  const FloatVec one = hn::Set(d, 1.0f), eight = hn::Set(d, 8.0f), zero = hn::Zero(d);
  for (int o = 0; o < 8; ++o) {
    const FloatVec apart = hn::Abs(hn::Sub(angle, hn::Set(d, static_cast<float>(o))));
    const FloatVec distance = hn::Min(apart, hn::Sub(eight, apart));
    const FloatVec share = hn::Mul(magnitude, hn::Max(zero, hn::Sub(one, distance)));
    float* upper = sums.line[c][o] + x;
    float* lower = sums.line[c + 1][o] + x;
    hn::Store(hn::MulAdd(share, upper_weight, hn::Load(d, upper)), d, upper);
    hn::Store(hn::MulAdd(share, lower_weight, hn::Load(d, lower)), d, lower);
  }
}

void SumOverColumns(const GridWeights& weights, const RowSums& sums, CellHistogram& out) {
  const FloatTag d;
  for (int cy = 0; cy < 4; ++cy) {
    for (int o = 0; o < 8; ++o) {
      for (int cx = 0; cx < 4; ++cx) {
        FloatVec sum = hn::Zero(d);
        for (int x = 0; x < kDescriptorGrid; x += static_cast<int>(hn::Lanes(d))) {
          sum = hn::MulAdd(hn::Load(d, weights.cell[cx] + x), hn::Load(d, sums.line[cy][o] + x), sum);
        }
        out[(cy * 4 + cx) * 8 + o] = hn::GetLane(hn::SumOfLanes(d, sum));
      }
    }
  }
}

void Descriptor(const FloatImage& image, const PatchFrame& frame, CellHistogram& out) {
  static const GridWeights weights;
  const FloatTag d;
  Samples<kDescriptorGrid> samples;
  SampleGrid<kDescriptorGrid>(image, frame, samples);
  RowSums sums;
  for (int y = 0; y < kDescriptorGrid; ++y) {
    const FloatVec row_window = hn::Set(d, weights.window[y]);
    for (int x = 0; x < kDescriptorGrid; x += static_cast<int>(hn::Lanes(d))) {
      FloatVec magnitude, angle;
      PolarGradient(d, samples.At(x, y), SampleStride(kDescriptorGrid), 8, magnitude, angle);
      magnitude = hn::Mul(magnitude, hn::Mul(row_window, hn::Load(d, weights.window + x)));
      AddToRowSums(d, weights, x, y, magnitude, angle, sums);
    }
  }
  SumOverColumns(weights, sums, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace drupe
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace drupe {

HWY_EXPORT(OrientationPatch);
HWY_EXPORT(Descriptor);

void SampleOrientationPatch(const FloatImage& image, const PatchFrame& frame, PatchGradient<kOrientationGrid>& out) {
  HWY_DYNAMIC_DISPATCH(OrientationPatch)(image, frame, out);
}

void SampleDescriptor(const FloatImage& image, const PatchFrame& frame, CellHistogram& out) {
  HWY_DYNAMIC_DISPATCH(Descriptor)(image, frame, out);
}

}  // namespace drupe
#endif
