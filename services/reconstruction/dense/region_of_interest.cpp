#include "reconstruction/dense/region_of_interest.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace drupe::dense {

namespace {

constexpr double kTrackShare = 0.02;  ///< tracks left out at either end: mismatches
// Enlargement at every side, in shares of the box's longest side; below, few tracks are found under the fruit's
// overhang.
constexpr double kEnlarge = 0.18;
constexpr double kEnlargeBelow = 0.4;
constexpr int kMarginPx = 24;

Eigen::AlignedBox3d RobustBox(const std::vector<Eigen::Vector3d>& points) {
  Eigen::AlignedBox3d box;
  Eigen::Vector3d low, high;
  std::vector<double> values(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i][axis];
    std::sort(values.begin(), values.end());
    const auto skip = static_cast<std::size_t>(kTrackShare * static_cast<double>(values.size()));
    low[axis] = values[skip];
    high[axis] = values[values.size() - 1 - skip];
  }
  box.extend(low);
  box.extend(high);
  return box;
}

}  // namespace

Result<RegionOfInterest> FindRegionOfInterest(const SparseModel& model, const DenseOptions& options) {
  RegionOfInterest region;
  if (model.tracks.empty()) return Unprocessable("no_seeds", "the sparse model has no tracks to start from");
  if (options.scene == DenseOptions::Scene::kAll || model.scale_source != ScaleSource::kBoard) return region;
  std::vector<Eigen::Vector3d> above;
  for (const Track& track : model.tracks) {
    if (track.position.z() > options.min_height_mm) above.push_back(track.position);
  }
  if (above.empty())
    return Unprocessable("no_seeds", "no track lies above the board: the fruit has no texture, or none is there");
  Eigen::AlignedBox3d box = RobustBox(above);
  const double side = box.sizes().maxCoeff();
  box.min() -= side * Eigen::Vector3d(kEnlarge, kEnlarge, kEnlargeBelow);
  box.max() += side * Eigen::Vector3d(kEnlarge, kEnlarge, kEnlarge);
  box.min().z() = std::max(box.min().z(), options.min_height_mm);
  region.box = box;
  return region;
}

PixelRect ProjectRegion(const RegionOfInterest& region, const PinholeCamera& camera, const Rigid3& cam_from_world) {
  const PixelRect whole{0, 0, camera.width, camera.height};
  if (!region.box) return whole;
  Eigen::AlignedBox2d bounds;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d in_cam =
        cam_from_world * region.box->corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    if (in_cam.z() <= 0) return whole;
    bounds.extend(Eigen::Vector2d(camera.fx * in_cam.x() / in_cam.z() + camera.cx,
                                  camera.fy * in_cam.y() / in_cam.z() + camera.cy));
  }
  const auto clip = [](double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  return {clip(std::floor(bounds.min().x()) - kMarginPx, camera.width),
          clip(std::floor(bounds.min().y()) - kMarginPx, camera.height),
          clip(std::ceil(bounds.max().x()) + kMarginPx, camera.width),
          clip(std::ceil(bounds.max().y()) + kMarginPx, camera.height)};
}

}  // namespace drupe::dense
