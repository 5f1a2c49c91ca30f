#pragma once

#include <array>

#include "image/image.h"

namespace drupe {

/// A square grid of samples turned by an angle: sample (i, j) lies `step` * (i - middle, j - middle), rotated, from the
/// centre.
struct PatchFrame {
  float x = 0, y = 0;          ///< centre, pixels
  float step = 1;              ///< distance of neighbouring samples, pixels
  float cosine = 1, sine = 0;  ///< of the angle from the picture's x to the patch's x
};

/// Side of the grid on which descriptors see the picture: 4 x 4 cells of 3 sigma and half a cell on every side, that is
/// 15 sigma, at 0.625 sigma a sample, which a picture blurred by sigma allows.
constexpr int kDescriptorGrid = 24;
/// Side of the grid for orientations: 9 sigma (3 times the window's 1.5 sigma on both sides).
constexpr int kOrientationGrid = 16;

/// Gradient of a patch in polar form, row-major.
template <int kGrid>
struct PatchGradient {
  alignas(64) std::array<float, kGrid * kGrid> magnitude;
  alignas(64) std::array<float, kGrid * kGrid> angle;  ///< in the patch's frame; full turn = `full_turn`, in [0, it]
};

/// cells[cy][o][cx]: what the patch's gradient gives to the 4 x 4 cells and 8 directions, each sample shared linearly
/// among the nearest in all three.
using CellHistogram = std::array<float, 128>;

/// Gradients on the grid for orientations; angles in bins of a circle of 36.
void SampleOrientationPatch(const FloatImage& image, const PatchFrame& frame, PatchGradient<kOrientationGrid>& out);

/// The unnormalised descriptor: [cy][cx][direction], Lowe's order.
void SampleDescriptor(const FloatImage& image, const PatchFrame& frame, CellHistogram& out);

}  // namespace drupe
