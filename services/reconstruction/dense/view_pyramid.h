#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/status.h"
#include "geometry/pinhole_camera.h"
#include "geometry/rigid3.h"
#include "image/image.h"

namespace drupe::dense {

/// A rectangle of pixels: x0 <= x < x1, y0 <= y < y1.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int Width() const { return x1 - x0; }
  int Height() const { return y1 - y0; }
  bool Empty() const { return x1 <= x0 || y1 <= y0; }
};

/// A pinhole without distortion, for one level of one view: pixel = f * xy + c.
struct LevelCamera {
  double fx = 0, fy = 0, cx = 0, cy = 0;

  Eigen::Vector2d Pixel(const Eigen::Vector3d& in_cam) const {
    return {fx * in_cam.x() / in_cam.z() + cx, fy * in_cam.y() / in_cam.z() + cy};
  }
  /// Direction with z = 1.
  Eigen::Vector3d Ray(double u, double v) const { return {(u - cx) / fx, (v - cy) / fy, 1.0}; }
};

/// Luma of 0..255, times 256, of a pixel in the low 16 bits and of its right neighbour in the high 16 bits, so that one
/// 32-bit load brings half of what bilinear interpolation needs.
using LumaPairs = Image<std::uint32_t>;

/// The part of a picture that shows the region of interest, without distortion, and its halved copies.
struct DenseView {
  int index = 0;  ///< in SparseModel::views
  Rigid3 cam_from_world;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  LevelCamera camera;           ///< of level 0, origin at the crop's first pixel
  RgbImage rgb;                 ///< level 0
  std::vector<LumaPairs> luma;  ///< [level]; empty below the finest level in use

  /// Pixel i of level l covers the pixels i 2^l .. (i + 1) 2^l - 1 of level 0.
  LevelCamera CameraAt(int level) const;
};

/// Resamples the crop `rect` (in pixels of camera.WithoutDistortion()) of a picture by Catmull-Rom interpolation, and
/// halves it `level_count` - 1 times with the kernel [1 3 3 1]/8. Pixels outside the picture repeat its border.
void BuildPyramid(const RgbImage& picture, const PinholeCamera& camera, const PixelRect& rect, int level_count,
                  DenseView* view);

/// Drops the levels that are finer than `level`.
void DropLevelsBelow(int level, DenseView* view);

}  // namespace drupe::dense
