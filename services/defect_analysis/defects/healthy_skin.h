#pragma once

#include <vector>

#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/skin_map.h"
#include "scene/fruit_cloud.h"

namespace drupe {

/// Colour of the skin's cells, and how far each is from what healthy skin has there.
struct SkinColours {
  std::vector<Eigen::Vector3f>
      deviation;                         ///< a cell's Lab minus the healthy Lab there, L already weighted; 0 if unseen
  std::vector<Eigen::Vector3f> healthy;  ///< Lab of healthy skin in a cell, L already weighted; 0 if unseen
  std::vector<std::uint8_t> seen;        ///< 1 where the cell or a neighbour holds points
  double sigma = 0;                      ///< robust standard deviation of |deviation| over the healthy skin
};

/// Removes shading and the skin's own large-scale colours: the healthy colour is a smooth function of direction, fitted
/// to the cells' median colours with rising degree and re-weighted so that spots, scars and decay do not draw it. What
/// remains is the same for a lit and a shaded spot. Errors: 422 `too_few_directions`.
Result<SkinColours> MeasureDeviation(const FruitCloud& fruit, const SkinMap& map, const SegmentationOptions& options);

}  // namespace drupe
