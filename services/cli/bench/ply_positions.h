#pragma once

#include <string>

#include "base/status.h"
#include "scene/point_cloud.h"

namespace drupe {

/// The positions of the vertices of another program's PLY file: ASCII or binary little-endian, any other properties
/// and lists among them (OpenMVS writes the views of each point as lists). What is not finite is left out. Errors: 422
/// `bad_ply`.
Result<PointCloud> ReadPlyPositions(const std::string& bytes);

}  // namespace drupe
