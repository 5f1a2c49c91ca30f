#pragma once

#include <string>

#include "base/status.h"
#include "cli/bench/peer_cloud.h"

namespace drupe {

/// Runs pmvs2 (Furukawa & Ponce 2010) at level 1, csize 2 and its other defaults on the model's views: writes
/// visualize/*.ppm without distortion, txt/*.txt with the projections, and its option file into `directory`. Errors:
/// 500 `peer_failed` with the place of its log, 422 `bad_ply`.
Result<PeerCloud> RunPmvs(const TruthSet& set, const SparseModel& model, const std::string& directory, int threads);

}  // namespace drupe
