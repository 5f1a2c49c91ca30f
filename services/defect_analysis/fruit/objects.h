#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/run_context.h"
#include "defect_analysis/fruit/ground.h"
#include "scene/point_cloud.h"

namespace drupe {

/// The extent of a cloud without its stray points: the box between the quantiles 0.002 and 0.998 of each axis, taken
/// over a sample.
struct CloudBox {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  double Diagonal() const { return (high - low).norm(); }
};
CloudBox RobustBox(const PointCloud& cloud);

/// Indices of the points of each connected object, most points first. Points lower than `clearance` above the ground
/// and points outside the box are left out; voxels of edge `voxel` (in the cloud's unit, enlarged where the box would
/// have more than 16 million) join over faces, edges and corners.
std::vector<std::vector<std::uint32_t>> FindObjects(const PointCloud& cloud, const CloudBox& box,
                                                    const std::optional<Ground>& ground, double clearance, double voxel,
                                                    int min_points);

}  // namespace drupe
