#pragma once

#include <string>

#include "base/status.h"
#include "image/image.h"
#include "scene/sparse_model.h"

namespace drupe {

/// Binary little-endian PLY: float x y z and uchar red green blue of every track.
std::string SparsePly(const SparseModel& model);

/// A zip of COLMAP's text model: cameras.txt (one camera, OPENCV or FULL_OPENCV), images.txt, points3D.txt. COLMAP puts
/// the centre of the first pixel at (0.5, 0.5), so principal point and observations are moved by half a pixel. Errors:
/// 500 `zip_too_large` beyond 4 GB.
Result<std::string> ColmapZip(const SparseModel& model);

/// A VisualSFM model (NVM_V3). Its camera has one focal length, one radial coefficient of another form and coordinates
/// from the image centre, so the measurements are written without distortion and with f = (fx + fy) / 2.
std::string Nvm(const SparseModel& model);

/// Gives every track whose middle observation (the one most likely to be seen face on) lies in `view` the colour of that
/// pixel, bilinear. Called once for each registered view, in any order, it colours every track. `image` has 3 channels
/// (RGB) or 1 (grey).
void ColourTracks(SparseModel& model, int view, const RgbImage& image);

}  // namespace drupe
