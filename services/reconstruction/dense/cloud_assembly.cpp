#include "reconstruction/dense/cloud_assembly.h"

#include <bit>
#include <cmath>

#include "base/parallel.h"

namespace drupe::dense {

namespace {

constexpr double kSeamSlack = 0.9998;  ///< lets the strips of two views overlap by a hair rather than gape

/// Standard uncertainty along the normal.
float NormalError(const DenseView& view, const SurfaceElement& element, float unit, const PatchCell& cell) {
  const Eigen::Vector3d ray = element.position - view.centre;
  const double depth = 1.0 / cell.w;
  return static_cast<float>(cell.sigma * unit * depth * std::abs(element.normal.dot(ray)));
}

void CollectView(const LevelContext& fine, const PatchMap& map, const LevelContext& coarse,
                 const std::vector<PatchMap>& coarse_maps, int view, PointCloud* cloud) {
  const DenseScene& scene = *fine.scene;
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      const PatchCell& cell = map.At(col, row);
      if (!cell.Filled() || IsBlack(fine, view, map.Pixel(col), map.Pixel(row))) continue;
      const SurfaceElement element =
          ToWorld(scene.views[view], fine.cameras[view], map.Pixel(col), map.Pixel(row), cell);
      if (!scene.region.Contains(element.position)) continue;
      if (!OwnsElement(coarse, view, coarse_maps, element, kSeamSlack)) continue;
      cloud->positions.push_back(element.position.cast<float>());
      cloud->normals.push_back(element.normal.cast<float>());
      cloud->view_counts.push_back(static_cast<std::uint8_t>(std::popcount(cell.views) + 1));
      cloud->ncc.push_back(cell.ncc);
      cloud->expected_error.push_back(NormalError(scene.views[view], element, map.unit, cell));
    }
  }
}

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

}  // namespace

Result<AssembledCloud> AssembleCloud(const LevelContext& fine, const std::function<PatchMap(int view)>& fine_map,
                                     const LevelContext& coarse, const std::vector<PatchMap>& coarse_maps,
                                     const RunContext& run) {
  std::vector<PointCloud> parts(coarse_maps.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, parts.size(), [&](std::size_t view) {
    const int index = static_cast<int>(view);
    CollectView(fine, fine_map(index), coarse, coarse_maps, index, &parts[view]);
  }));
  AssembledCloud result;
  for (std::size_t view = 0; view < parts.size(); ++view) {
    Append(parts[view].positions, &result.cloud.positions);
    Append(parts[view].normals, &result.cloud.normals);
    Append(parts[view].view_counts, &result.cloud.view_counts);
    Append(parts[view].ncc, &result.cloud.ncc);
    Append(parts[view].expected_error, &result.cloud.expected_error);
    result.owners.insert(result.owners.end(), parts[view].size(), static_cast<int>(view));
    parts[view] = PointCloud();
  }
  return result;
}

}  // namespace drupe::dense
