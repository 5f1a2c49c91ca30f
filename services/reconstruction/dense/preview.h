#pragma once

#include <cstddef>

#include "scene/point_cloud.h"

namespace drupe {

/// A cloud of about `target` points (within a few percent, when it has more) for viewers and for meshing: the means of
/// the points in the cubes of a grid, whose side is chosen for that number. Attributes are averaged, normals to unit
/// length; the order is that of each cube's first point. Depends on nothing but the cloud.
PointCloud DecimateCloud(const PointCloud& cloud, std::size_t target);

}  // namespace drupe
