#include "reconstruction/dense/patch_map.h"

#include <algorithm>
#include <cmath>

namespace drupe::dense {

PatchMap::PatchMap(int level_in, int csize_in, int width, int height, float unit_in)
    : level(level_in),
      csize(csize_in),
      cols(width / csize_in),
      rows(height / csize_in),
      unit(unit_in),
      cells(static_cast<std::size_t>(cols) * rows) {}

int PatchMap::CellOf(double pixel) const {
  return static_cast<int>(std::floor((pixel + 0.5) / csize));
}

SurfaceElement ToWorld(const DenseView& view, const LevelCamera& camera, double u, double v, const PatchCell& plane) {
  const Eigen::Vector3d ray = camera.Ray(u, v);
  // The plane is m . x = 1 in the camera's frame, with m . ray = 1/z.
  Eigen::Vector3d m(plane.wu * camera.fx, plane.wv * camera.fy, 0);
  m.z() = plane.w - m.x() * ray.x() - m.y() * ray.y();
  const Eigen::Matrix3d to_world = view.cam_from_world.rotation.transpose();
  return {view.centre + to_world * (ray / plane.w), -(to_world * m).normalized()};
}

PatchCell FromWorld(const DenseView& view, const LevelCamera& camera, const SurfaceElement& element) {
  PatchCell plane;
  const Eigen::Vector3d in_cam = view.cam_from_world * element.position;
  const Eigen::Vector3d normal = view.cam_from_world.rotation * element.normal;
  const double facing = normal.dot(in_cam);
  if (in_cam.z() <= 0 || facing >= 0) return plane;
  const Eigen::Vector3d m = normal / facing;
  plane.w = static_cast<float>(1 / in_cam.z());
  plane.wu = static_cast<float>(m.x() / camera.fx);
  plane.wv = static_cast<float>(m.y() / camera.fy);
  return plane;
}

}  // namespace drupe::dense
