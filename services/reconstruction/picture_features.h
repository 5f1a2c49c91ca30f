#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/pipeline.h"
#include "scene/board.h"
#include "scene/features.h"

namespace drupe {

/// What one picture holds.
struct PictureFeatures {
  Features features;
  BoardDetection detection;  ///< empty without a board
};

/// Finds the features of `source` and, when `input` has a board, its corners, on one thread. What the cache of `input`
/// holds of a picture with a digest is taken from there, and what it does not hold is left there, so that the same call
/// while pictures arrive makes that of the reconstruction short. `input.images` is not looked at. Errors: those of
/// reading, decoding, RunFeatures and DetectBoard; `cancelled`.
Result<PictureFeatures> FindPictureFeatures(const SourceImage& source, const ReconstructionInput& input,
                                            const ReconstructionOptions& options, const RunContext& context);

/// The features alone, likewise.
Result<Features> FindFeatures(const SourceImage& source, const ReconstructionInput& input,
                              const ReconstructionOptions& options, const RunContext& context);

/// Whether anything that follows from `source` is looked for and left in the cache of `input`.
bool IsCached(const SourceImage& source, const ReconstructionInput& input);

}  // namespace drupe
