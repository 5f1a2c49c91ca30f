#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reconstruction/dense/level_context.h"

namespace drupe::dense {

/// One view's share of the finest level: the patches of the level above, and which of them it refines (PredictGuesses).
struct ViewWork {
  int view = 0;
  const PatchMap* coarse = nullptr;
  const std::vector<std::uint8_t>* wanted = nullptr;
};

/// All that RunDensePart needs for some views, as bytes: the scene's geometry, the views' neighbours and silhouettes,
/// and the coarse patches about the wanted ones; not the pictures, which are named. A line of JSON, then raw values.
std::string WritePart(const LevelContext& fine, const std::vector<ViewWork>& work);

/// What WritePart wrote. The scene's pointers and pictures are not set.
struct Part {
  SparseModel model;  ///< its camera and views alone
  DenseScene scene;   ///< views and their neighbours, in the order of model.views
  int finest = 0, csize = 1;
  std::vector<PatchMap> coarse;  ///< of the first views
  std::vector<std::vector<std::uint8_t>> wanted;
};

/// Errors: 422 `bad_part`, 400 as ParseJson.
Result<Part> ReadPart(std::string_view bytes);

}  // namespace drupe::dense
