#include "reconstruction/dense/prediction.h"

#include <algorithm>
#include <cmath>

namespace drupe::dense {

namespace {

constexpr float kBlendParallax = 1.0f;  ///< pixels of parallax between planes that are blended

/// A weighted sum of planes about one pixel.
struct Blend {
  PatchCell plane;
  float weight = 0;

  void Add(const PatchCell& cell, float w, float share, float unit) {
    if (weight > 0 && std::abs(w - plane.w / weight) > kBlendParallax * unit) return;
    plane.w += share * w;
    plane.wu += share * cell.wu;
    plane.wv += share * cell.wv;
    plane.bend += share * cell.bend;
    plane.ncc += share * cell.ncc;
    plane.sigma += share * cell.sigma;
    plane.views |= cell.views;
    weight += share;
  }
  void Normalise() {
    const float inverse = 1.0f / weight;
    for (float* value : {&plane.w, &plane.wu, &plane.wv, &plane.bend, &plane.ncc, &plane.sigma}) *value *= inverse;
  }
};

/// The blend at a pixel (u, v) of the coarse level; weight 0 without a patch near.
Blend BlendAt(const PatchMap& coarse, const std::vector<std::uint8_t>& wanted, float u, float v) {
  const float x = (u - static_cast<float>(coarse.Pixel(0))) / static_cast<float>(coarse.csize);
  const float y = (v - static_cast<float>(coarse.Pixel(0))) / static_cast<float>(coarse.csize);
  const int col = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const float fx = x - static_cast<float>(col), fy = y - static_cast<float>(row);
  Blend blend;
  bool any_wanted = wanted.empty();
  for (int corner = 0; corner < 4; ++corner) {
    const int c = col + (corner & 1), r = row + (corner >> 1);
    if (!coarse.Holds(c, r) || !coarse.At(c, r).Filled()) continue;
    if (!any_wanted) any_wanted = wanted[static_cast<std::size_t>(r) * coarse.cols + c] != 0;
    const PatchCell& cell = coarse.At(c, r);
    const float share = ((corner & 1) ? fx : 1 - fx) * ((corner >> 1) ? fy : 1 - fy) + 1e-4f;
    const float w = cell.w + cell.wu * (u - static_cast<float>(coarse.Pixel(c))) +
                    cell.wv * (v - static_cast<float>(coarse.Pixel(r)));
    blend.Add(cell, w, share, coarse.unit);
  }
  if (!any_wanted) blend.weight = 0;
  return blend;
}

}  // namespace

std::vector<PatchGuess> PredictGuesses(const PatchMap& coarse, const std::vector<std::uint8_t>& wanted,
                                       const PatchMap& fine) {
  const float scale = std::ldexp(1.0f, fine.level - coarse.level);
  std::vector<PatchGuess> guesses;
  for (int row = 0; row < fine.rows; ++row) {
    for (int col = 0; col < fine.cols; ++col) {
      const float u = (static_cast<float>(fine.Pixel(col)) + 0.5f) * scale - 0.5f;
      const float v = (static_cast<float>(fine.Pixel(row)) + 0.5f) * scale - 0.5f;
      Blend blend = BlendAt(coarse, wanted, u, v);
      if (blend.weight <= 0) continue;
      blend.Normalise();
      blend.plane.wu *= scale;
      blend.plane.wv *= scale;
      blend.plane.bend *= scale * scale;
      blend.plane.sigma /= scale;
      guesses.push_back({row * fine.cols + col, blend.plane});
    }
  }
  return guesses;
}

}  // namespace drupe::dense
