#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace drupe {

/// A pinhole camera with Brown-Conrady distortion [k1, k2, p1, p2, k3], as OpenCV defines it. Pixel centres lie at
/// integer coordinates: (0, 0) is the centre of the top left pixel.
struct PinholeCamera {
  int width = 0;   ///< pixels
  int height = 0;  ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::array<double, 5> dist{};           ///< k1, k2, p1, p2, k3

  /// Normalised image coordinates (x/z, y/z) to pixels, with distortion.
  Eigen::Vector2d PixelFromNormalised(const Eigen::Vector2d& xy) const;
  /// As above, with the 2x2 Jacobian d(pixel)/d(xy).
  Eigen::Vector2d PixelFromNormalised(const Eigen::Vector2d& xy, Eigen::Matrix2d* jacobian) const;
  /// Pixels to normalised coordinates without distortion (Newton's method, to 1e-12; converges for every real lens).
  Eigen::Vector2d NormalisedFromPixel(const Eigen::Vector2d& pixel) const;
  /// A point in the camera frame to pixels; nothing when it lies behind the camera.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& point_in_cam) const;

  Eigen::Matrix3d K() const;
  /// The same camera without distortion.
  PinholeCamera WithoutDistortion() const;
  bool HasDistortion() const;
};

}  // namespace drupe
