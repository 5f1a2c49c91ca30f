#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"

namespace drupe {

/// One half of a symmetric smoothing kernel: weights[0] is the centre's, weights[k] that of both pixels k away.
struct BlurKernel {
  std::vector<float> weights;
  int radius() const { return static_cast<int>(weights.size()) - 1; }
};

/// A sampled Gaussian that sums to 1; sigma > 0 in pixels.
BlurKernel GaussianKernel(double sigma);

/// Rows [row_begin, row_end) of `source` smoothed by `kernel` in both directions, into the same rows of `target`, which
/// has the source's size. The picture goes on beyond its border with the border's values. Reads the source's rows up to
/// kernel.radius() outside the range.
void BlurRows(const GrayImage& source, const BlurKernel& kernel, int row_begin, int row_end, FloatImage& target);
void BlurRows(const FloatImage& source, const BlurKernel& kernel, int row_begin, int row_end, FloatImage& target);

}  // namespace drupe
