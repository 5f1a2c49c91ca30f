#pragma once

#include <string>

#include "base/status.h"
#include "cli/bench/peer_cloud.h"

namespace drupe {

/// True when OpenMVS's InterfaceCOLMAP and DensifyPointCloud are on PATH.
bool HasOpenMvs();

/// Runs OpenMVS on the model's views at half resolution, its default: writes images/*.png without distortion and the
/// poses and tracks as sparse/*.txt (COLMAP's, which InterfaceCOLMAP reads) into `directory`; the cost is that of both
/// programs. Errors: 500 `peer_failed` with the place of the log, 422 `bad_ply`.
Result<PeerCloud> RunOpenMvs(const TruthSet& set, const SparseModel& model, const std::string& directory, int threads);

}  // namespace drupe
