#pragma once

#include <string>
#include <vector>

#include "base/status.h"
#include "cli/bench/peer_process.h"
#include "cli/bench/truth_set.h"
#include "image/image.h"
#include "scene/point_cloud.h"
#include "scene/sparse_model.h"

namespace drupe {

/// What another program made of our poses.
struct PeerCloud {
  PeerRun run;
  PointCloud cloud;  ///< positions alone, in the model's world
};

/// The picture of a view without the lens's distortion, as the peers want it. Errors: 400 `bad_truth`; those of
/// decoding.
Result<RgbImage> FlatPicture(const TruthSet& set, const SparseModel& model, const View& view);

/// Creates `directory` and the folders in it. Errors: 400 `bad_output`.
Status MakeFolders(const std::string& directory, const std::vector<std::string>& folders);

}  // namespace drupe
