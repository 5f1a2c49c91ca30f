#pragma once

#include <cstdint>
#include <vector>

#include "defect_analysis/defects/healthy_skin.h"
#include "defect_analysis/defects/segmentation.h"
#include "defect_analysis/defects/skin_map.h"
#include "scene/fruit_cloud.h"

namespace drupe {

/// The colour class of every point of a fruit. Cells decide where a defect is, being less noisy than points; points
/// decide where it ends: in a connected group of defect cells and the cells that border it, a point belongs to the
/// defect when its own colour, shading off, lies more than half-way, in linear light, from the skin about the group,
/// clear of its soft edge, to the colour of the group's core. A faint spot so ends where it looks half as faint,
/// whatever the other spots' colours are. Groups smaller than min_area_mm2 are no defects.
std::vector<std::uint8_t> ClassifyPoints(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours,
                                         const Segmentation& segmentation, const SegmentationOptions& options,
                                         const ClusterOptions& cluster = {});

/// A point's colour minus that of healthy skin there, L weighted: what ClassifyPoints compares.
std::vector<Eigen::Vector3f> PointDeviations(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours,
                                             const SegmentationOptions& options);

}  // namespace drupe
