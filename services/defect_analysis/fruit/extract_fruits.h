#pragma once

#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "defect_analysis/fruit/background_options.h"
#include "defect_analysis/fruit/fruit_options.h"
#include "scene/colour_model.h"
#include "scene/fruit_cloud.h"
#include "scene/point_cloud.h"

namespace drupe {

/// How the cloud lies in space.
struct FruitScene {
  bool metric = false;  ///< the cloud is in mm, in the board's frame (z = 0 on the board, z up)
  std::vector<Eigen::Vector3d> camera_centres;
  const ColourModel* background_model = nullptr;  ///< none: geometry alone
};

/// Background removal (paper 4.1): cuts the ground off, separates the objects above it, keeps those that a closed
/// smooth surface of a fruit's size fits, and drops the points that are not on that surface (needle, strays), then
/// those in doubt whose colour is the background's (RemoveForeignColours). Where geometry finds no fruit, it tries
/// again with the points of a fruit's colour alone. Fruits come largest first. Without a metric scale each fruit is
/// scaled to the nominal diameter, and FruitCloud::mm_per_unit says by how much. A cloud without fruit gives none.
/// Errors: `cancelled`.
Result<std::vector<FruitCloud>> ExtractFruits(const PointCloud& cloud, const FruitScene& scene,
                                              const FruitOptions& options, const BackgroundOptions& background,
                                              const RunContext& context);

}  // namespace drupe
