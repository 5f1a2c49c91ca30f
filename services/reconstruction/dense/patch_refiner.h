#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reconstruction/dense/view_pyramid.h"

namespace drupe::dense {

/// Up to kSize patches of one reference view at one level. A patch is a plane through the surface, given as inverse
/// depth over the reference pixels: 1/z(u + du, v + dv) = w + wu du + wv dv, which is exact for a plane.
struct PatchBatch {
  static constexpr int kSize = 16;
  using Lanes = std::array<float, kSize>;

  int count = 0;
  alignas(64) Lanes u{}, v{};         ///< reference pixel, whole numbers
  alignas(64) Lanes w{}, wu{}, wv{};  ///< in: first guess and centre of the prior; out: refined
  alignas(64) Lanes depth_sigma{};    ///< of the prior on w, in frame units (pixels of parallax); > 0
  alignas(64) std::array<std::uint32_t, kSize> views{};  ///< bit k: neighbour k. In: to be compared; out: agrees
  alignas(64) Lanes ncc{};                               ///< out: mean NCC over the agreeing neighbours; 0 without any
  alignas(64) Lanes sigma{};  ///< out: standard uncertainty of w, in frame units (pixels of parallax)
  alignas(64) Lanes moved{};  ///< out: |w - first guess| in frame units
};

/// A picture that patches are sampled from.
struct SampledImage {
  const std::uint32_t* pairs = nullptr;  ///< see LumaPairs
  std::int32_t stride = 0;               ///< values from row to row
  std::int32_t width = 0, height = 0;
};

/// A neighbour as seen from the reference: (u, v) with inverse depth w is at a (u, v, 1) + b w, homogeneous.
struct NeighbourWarp {
  SampledImage image;
  std::array<float, 9> a{};  ///< row-major
  std::array<float, 3> b{};
};

/// One reference view at one level with its neighbours.
struct RefinerFrame {
  SampledImage reference;
  std::vector<NeighbourWarp> neighbours;  ///< at most 32
  float unit = 1;                         ///< the change of inverse depth that moves a typical neighbour's pixel by one
};

struct RefinerSettings {
  int half = 3;                 ///< the window is 2 half + 1 pixels wide, at most kMaxHalf
  int iterations = 6;           ///< at most; a patch stops when its step is below 0.01 pixels
  float slope_sigma = 0.2f;     ///< of the prior on wu and wv, in frame units a pixel
  float least_view_ncc = 0.5f;  ///< a neighbour below this does not agree

  static constexpr int kMaxHalf = 7;
};

/// The frame of views[reference] at `level`.
RefinerFrame MakeRefinerFrame(const std::vector<DenseView>& views, int reference, const std::vector<int>& neighbours,
                              int level, double typical_depth);

/// Fits w, wu and wv of each patch so that the neighbours' windows, warped by the plane, agree with the reference
/// window up to gain and offset: Gauss-Newton on the residuals that are left after the best gain and offset, with the
/// reference's gradients (as in inverse compositional alignment, Baker & Matthews 2004), every neighbour weighted by
/// the inverse variance of its residuals. Patches lie in vector lanes, so a patch's result does not depend on the
/// others in its batch nor on the width of the vectors. The whole window (and one pixel around it) must lie inside
/// the reference; a neighbour whose window leaves its picture is dropped.
void RefinePatches(const RefinerFrame& frame, const RefinerSettings& settings, PatchBatch* batch);

}  // namespace drupe::dense
