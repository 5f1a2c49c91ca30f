#pragma once

#include "base/json.h"
#include "base/limits.h"
#include "base/status.h"
#include "reconstruction/board/board_detector.h"
#include "reconstruction/clusters/clusters.h"
#include "reconstruction/clusters/cycle_consistency.h"
#include "reconstruction/dense/dense.h"
#include "reconstruction/features/features.h"
#include "reconstruction/matching/matching.h"
#include "reconstruction/matching/tracks.h"
#include "reconstruction/similarity/similarity.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// The options of every stage, in the order of the data. In JSON each has a key of its name.
struct ReconstructionOptions {
  FeatureOptions features;
  BoardDetectorOptions board;
  SimilarityOptions similarity;
  ViewClusterOptions clusters;
  MatchingOptions matching;
  CycleOptions cycles;
  TrackOptions tracks;
  SparseOptions sparse;
  DenseOptions dense;
  /// Let the final adjustment change a given calibration. Always done when none is given.
  bool refine_intrinsics = false;
  /// False stops after the sparse model: poses only.
  bool run_dense = true;

  /// The first stage's message whose options are out of range.
  Status Check() const;
};

/// Reads {"features": {...}, "matching": {...}, "dense": {...}, ..., "refine_intrinsics": bool, "run_dense": bool};
/// null and absent keys keep their defaults. Errors: 400 `unknown_option`, `invalid_option`, with the field.
Result<ReconstructionOptions> ParseReconstructionOptions(const Json& json);

/// The options as they were used, for the report's provenance; ParseReconstructionOptions reads it back.
Json ToJson(const ReconstructionOptions& options);

}  // namespace drupe
