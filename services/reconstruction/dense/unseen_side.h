#pragma once

#include "scene/point_cloud.h"

namespace drupe::dense {

/// Points with normals (nothing else filled) where no view saw a fruit, its underside: on the surface that continues
/// the seen skin with the least bending (a smooth function of direction, FitSphericalFunction). Without them a
/// reconstruction from points cuts the open side off flat. None where the cloud is no single body that bulges outward
/// everywhere about its middle (several fruits, a wall), or where all of it was seen.
PointCloud GuessUnseenSide(const PointCloud& cloud);

}  // namespace drupe::dense
