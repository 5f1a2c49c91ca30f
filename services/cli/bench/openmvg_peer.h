#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "cli/bench/sfm_run.h"
#include "cli/bench/truth_set.h"

namespace drupe {

/// True when every program of OpenMVG that RunOpenMvg needs is on PATH.
bool HasOpenMvg();

/// Runs OpenMVG 2 (Moulon, Monasse, Perrot & Marlet 2017) on a set with the set's calibration as a fixed camera:
/// openMVG_main_SfMInit_ImageListing, ComputeFeatures, PairGenerator (all pairs), ComputeMatches, GeometricFilter
/// (essential matrices), SfM (incremental), ConvertSfM_DataFormat. Its files and logs are left in `directory`, which
/// must exist and be empty. Its camera has one focal length: the mean of both. Errors: 500 `peer_not_started`,
/// `peer_failed` with the log's place, 422 `bad_peer_model`.
Result<SfmRun> RunOpenMvg(const TruthSet& set, const std::string& directory);

/// Sets the lens of every intrinsic of an sfm_data.json that has OpenMVG's Brown model (`pinhole_brown_t2`), which its
/// command line cannot. Errors: 422 `bad_peer_model`.
Status SetOpenMvgLens(const PinholeCamera& camera, Json& sfm_data);

/// The views of an sfm_data.json; those without extrinsics have no pose. Errors: 422 `bad_peer_model`.
Result<std::vector<View>> ParseOpenMvgViews(const Json& sfm_data);

}  // namespace drupe
