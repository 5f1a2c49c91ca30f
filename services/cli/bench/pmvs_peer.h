#pragma once

#include <string>

#include "base/status.h"
#include "cli/bench/peer_process.h"
#include "cli/bench/truth_set.h"
#include "scene/point_cloud.h"
#include "scene/sparse_model.h"

namespace drupe {

/// What another program made of our poses.
struct PeerCloud {
  PeerRun run;
  PointCloud cloud;  ///< positions alone, in the model's world
};

/// Runs pmvs2 (Furukawa & Ponce 2010) at level 1, csize 2 and its other defaults on the model's views: writes
/// visualize/*.ppm without distortion, txt/*.txt with the projections, and its option file into `directory`. Errors:
/// 500 `peer_failed` with the place of its log.
Result<PeerCloud> RunPmvs(const TruthSet& set, const SparseModel& model, const std::string& directory, int threads);

/// Positions of an ASCII PLY file, as pmvs2 writes it. Errors: 422 `bad_ply`.
Result<PointCloud> ReadAsciiPositions(const std::string& text);

}  // namespace drupe
