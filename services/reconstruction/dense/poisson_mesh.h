#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "scene/ply_mesh.h"
#include "scene/point_cloud.h"

namespace drupe {

/// The closed surface through a cloud with normals (screened Poisson reconstruction's predecessor, Kazhdan, Bolitho &
/// Hoppe 2006, by PCL): where nothing was seen, below the fruit and around its stalk, it closes the surface, a
/// single fruit's by the continuation of least bending (GuessUnseenSide), several fruits' nearly flat.
/// For volume and area, and for viewers; the points themselves are what is measured on. Errors: 422 `no_mesh` when the
/// cloud has fewer than 100 points, no normals, or gives no closed surface; `cancelled` before and after the library's
/// work, which takes some seconds and cannot be stopped.
Result<TriangleMesh> BuildPoissonMesh(const PointCloud& cloud, const RunContext& context);

}  // namespace drupe
