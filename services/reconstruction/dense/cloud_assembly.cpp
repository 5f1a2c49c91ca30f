#include "reconstruction/dense/cloud_assembly.h"

#include <bit>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "reconstruction/dense/duplicates.h"

namespace drupe::dense {

namespace {

/// The points of one view, and those of them that lie near its strip's border (indices in `cloud`).
struct ViewPoints {
  PointCloud cloud;
  std::vector<SeamPoint> seam;
};

/// Radians of parallax: what the lamps, which stand still while the fruit turns, do to the patches. Shading and gloss
/// cover as much of the fruit however fine the pixels are, so this does not shrink with them: on rendered fruits of 720
/// to 2160 lines the error's slowly varying part is the same.
constexpr double kLampBias = 3.2e-5;
/// Of the fit's own uncertainty, which counts neighbouring patches as one as far as their windows overlap at all.
constexpr double kScatterShare = 0.5;

/// Standard uncertainty along the normal. `focal_px`, `unit`: of the level.
float NormalError(const DenseView& view, const SurfaceElement& element, double focal_px, float unit,
                  const PatchCell& cell) {
  const Eigen::Vector3d ray = element.position - view.centre;
  const double depth = 1.0 / cell.w;
  const double sigma = std::hypot(kScatterShare * static_cast<double>(cell.sigma), kLampBias * focal_px);
  return static_cast<float>(sigma * unit * depth * std::abs(element.normal.dot(ray)));
}

void CollectView(const LevelContext& fine, const PatchMap& map, const LevelContext& coarse,
                 const std::vector<PatchMap>& coarse_maps, int view, ViewPoints* points) {
  const DenseScene& scene = *fine.scene;
  PointCloud* cloud = &points->cloud;
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      const PatchCell& cell = map.At(col, row);
      if (!cell.Filled() || IsBackground(fine, view, map.Pixel(col), map.Pixel(row))) continue;
      const SurfaceElement element =
          ToWorld(scene.views[view], fine.cameras[view], map.Pixel(col), map.Pixel(row), cell);
      if (!scene.region.Contains(element.position)) continue;
      const double lead = OwnerLead(coarse, view, coarse_maps, element);
      if (lead < -kSeamOverlap) continue;
      if (lead < 3 * kSeamOverlap) {
        points->seam.push_back({static_cast<std::uint32_t>(cloud->size()), view, static_cast<float>(lead),
                                static_cast<float>(map.csize / (cell.w * fine.cameras[view].fx))});
      }
      cloud->positions.push_back(element.position.cast<float>());
      cloud->normals.push_back(element.normal.cast<float>());
      cloud->view_counts.push_back(static_cast<std::uint8_t>(std::popcount(cell.views) + 1));
      cloud->ncc.push_back(cell.ncc);
      cloud->expected_error.push_back(NormalError(scene.views[view], element, fine.cameras[view].fx, map.unit, cell));
    }
  }
}

template <typename T>
void AppendKept(const std::vector<T>& from, const std::vector<std::uint8_t>& stays, std::size_t first,
                std::vector<T>* to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (stays[first + i]) to->push_back(from[i]);
  }
}

/// The points of all views that are not double.
AssembledCloud Join(std::vector<ViewPoints>* parts) {
  PointCloud places;  // positions alone, which is all that MarkDistinct looks at
  std::vector<SeamPoint> seam;
  for (const ViewPoints& part : *parts) {
    const auto first = static_cast<std::uint32_t>(places.size());
    for (SeamPoint point : part.seam) {
      point.index += first;
      seam.push_back(point);
    }
    places.positions.insert(places.positions.end(), part.cloud.positions.begin(), part.cloud.positions.end());
  }
  const std::vector<std::uint8_t> stays = MarkDistinct(places, std::move(seam));
  AssembledCloud result;
  std::size_t first = 0;
  for (std::size_t view = 0; view < parts->size(); ++view) {
    PointCloud& part = (*parts)[view].cloud;
    AppendKept(part.positions, stays, first, &result.cloud.positions);
    AppendKept(part.normals, stays, first, &result.cloud.normals);
    AppendKept(part.view_counts, stays, first, &result.cloud.view_counts);
    AppendKept(part.ncc, stays, first, &result.cloud.ncc);
    AppendKept(part.expected_error, stays, first, &result.cloud.expected_error);
    result.owners.resize(result.cloud.size(), static_cast<int>(view));
    first += part.size();
    part = PointCloud();
  }
  return result;
}

}  // namespace

Result<AssembledCloud> AssembleCloud(const LevelContext& fine,
                                     const std::function<Result<PatchMap>(int view)>& fine_map,
                                     const LevelContext& coarse, const std::vector<PatchMap>& coarse_maps,
                                     const RunContext& run) {
  std::vector<ViewPoints> parts(coarse_maps.size());
  std::vector<Status> outcomes(parts.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, parts.size(), [&](std::size_t view) {
    const int index = static_cast<int>(view);
    const Result<PatchMap> map = fine_map(index);
    outcomes[view] = map.status();
    if (map.ok()) CollectView(fine, *map, coarse, coarse_maps, index, &parts[view]);
  }));
  for (const Status& outcome : outcomes) DRUPE_RETURN_IF_ERROR(outcome);
  return Join(&parts);
}

}  // namespace drupe::dense
