#pragma once

#include <string>
#include <vector>

#include "base/status.h"
#include "cli/bench/sfm_run.h"
#include "cli/bench/truth_set.h"

namespace drupe {

/// Which pairs COLMAP matches.
struct ColmapPairs {
  int window = 4;           ///< every picture with so many that follow it, round from the last to the first
  bool exhaustive = false;  ///< all pairs instead
};

/// Runs COLMAP (Schoenberger & Frahm 2016) on a set on the CPU, with the set's calibration as a fixed camera:
/// feature_extractor, matches_importer or exhaustive_matcher, mapper, model_converter. Its files and logs are left in
/// `directory`, which must exist and be empty. Errors: 500 `peer_not_started`, `peer_failed` with the log's place.
Result<SfmRun> RunColmap(const TruthSet& set, const ColmapPairs& pairs, const std::string& directory);

/// The poses of COLMAP's images.txt. Errors: 422 `bad_peer_model`.
Result<std::vector<View>> ParseColmapImages(const std::string& text);

/// The number of points of COLMAP's points3D.txt.
std::size_t CountColmapPoints(const std::string& text);

/// A camera as COLMAP's parameters: OPENCV, or FULL_OPENCV where the third radial coefficient is needed.
struct ColmapCamera {
  std::string model;
  std::string parameters;  ///< comma between; COLMAP's first pixel has its centre at (0.5, 0.5)
};
ColmapCamera ColmapCameraOf(const PinholeCamera& camera);

}  // namespace drupe
