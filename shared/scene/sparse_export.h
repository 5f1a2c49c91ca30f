#pragma once

#include <string>

#include "image/image.h"
#include "scene/sparse_model.h"

namespace drupe {

/// Binary little-endian PLY: float x y z, uchar red green blue of every track, float sigma (standard uncertainty of the
/// position, in the unit of x y z; 0: not known) and error (mean reprojection error, pixels).
std::string SparsePly(const SparseModel& model);

/// A VisualSFM model (NVM_V3). Its camera has one focal length, one radial coefficient of another form and coordinates
/// from the image centre, so the measurements are written without distortion and with f = (fx + fy) / 2.
std::string Nvm(const SparseModel& model);

/// Gives every track whose middle observation (the one most likely to be seen face on) lies in `view` the colour of
/// that pixel, bilinear. Called once for each registered view, in any order, it colours every track. `image` has 3
/// channels (RGB) or 1 (grey).
void ColourTracks(SparseModel& model, int view, const RgbImage& image);

}  // namespace drupe
