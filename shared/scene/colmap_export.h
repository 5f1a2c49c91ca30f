#pragma once

#include <string>

#include "base/status.h"
#include "scene/sparse_model.h"

namespace drupe {

/// A zip of COLMAP's model, as text (cameras.txt images.txt points3D.txt) and as binary (cameras.bin images.bin
/// points3D.bin, which COLMAP prefers where both are): one camera, OPENCV or FULL_OPENCV, ids counting from 1 in the
/// order of the views and tracks, the same in both. COLMAP puts the centre of the first pixel at (0.5, 0.5), so
/// principal point and observations are moved by half a pixel. Errors: 500 `zip_too_large` beyond 4 GB.
Result<std::string> ColmapZip(const SparseModel& model);

}  // namespace drupe
