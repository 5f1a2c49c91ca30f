#pragma once

#include <vector>

#include "base/run_context.h"
#include "image/image.h"
#include "reconstruction/features/features.h"

namespace drupe {

/// One octave of a Gaussian scale space: scales_per_octave + 3 pictures of one size, grey values 0..255, the k-th
/// blurred to sigma = base_sigma * 2^(k / scales_per_octave) pixels of the octave.
struct Octave {
  float pixel_step = 1;            ///< pixels of the full picture per pixel of the octave; sample (0, 0) is its (0, 0)
  std::vector<FloatImage> levels;  ///< all of one size

  int width() const { return levels.front().width(); }
  int height() const { return levels.front().height(); }
};

/// Called while an octave is built, with the number of rows (from the top) that all its levels have by then: what works
/// on rows while they are in the cache need not fetch them again.
class OctaveObserver {
 public:
  virtual ~OctaveObserver() = default;
  virtual void OnRows(const Octave& octave, int octave_index, int finished_rows) = 0;
};

/// The Gaussian scale space of a picture (Lowe 2004, section 3), finest octave first; every octave below the first is
/// the one above at half the size. Errors: `cancelled`.
Result<std::vector<Octave>> BuildScaleSpace(const GrayImage& image, const FeatureOptions& options,
                                            const RunContext& context, OctaveObserver& observer);

}  // namespace drupe
