#pragma once

#include <cstdint>
#include <vector>

#include "defect_analysis/defects/healthy_skin.h"
#include "defect_analysis/defects/segmentation.h"
#include "defect_analysis/defects/skin_map.h"
#include "scene/fruit_cloud.h"

namespace drupe {

/// The colour class of every point of a fruit. In cells of a defect's class, and in those that border them, a point
/// belongs to the class whose centre its own colour, shading off, is nearest to; elsewhere it is healthy. Cells decide
/// where a defect is, being less noisy than points; points decide where it ends.
std::vector<std::uint8_t> ClassifyPoints(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours,
                                         const Segmentation& segmentation, const SegmentationOptions& options);

/// A point's colour minus that of healthy skin there, L weighted: what ClassifyPoints compares.
std::vector<Eigen::Vector3f> PointDeviations(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours,
                                             const SegmentationOptions& options);

}  // namespace drupe
