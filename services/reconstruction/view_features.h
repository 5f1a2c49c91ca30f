#pragma once

#include <string>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/pipeline.h"
#include "scene/board.h"
#include "scene/features.h"

namespace drupe {

/// What the pictures of a set hold, after each was decoded once. Vectors are parallel; pictures that could not be used
/// are in `refused` instead.
struct ViewFeatures {
  std::vector<int> sources;  ///< index into ReconstructionInput::images
  std::vector<std::string> names;
  std::vector<Features> features;
  std::vector<BoardDetection> detections;  ///< empty without a board
  std::vector<RefusedImage> refused;
  int width = 0;
  int height = 0;
  double exif_focal_px = 0;  ///< median over the pictures that state one; 0: none does
};

/// First step of the pipeline: decodes every picture, finds its features and the corners of the board, on all threads.
/// The set's picture size is the calibration's, or the most frequent one; pictures of another size are refused.
Result<ViewFeatures> FindViewFeatures(const ReconstructionInput& input, const ReconstructionOptions& options,
                                      const RunContext& context);

}  // namespace drupe
