#include "reconstruction/sparse/focal_from_board.h"

#include <algorithm>
#include <cmath>

#include "geometry/homography_fit.h"

namespace drupe {
namespace {

/// The homography from the board's plane (in units of `board_scale` mm) to pixels from the principal point in
/// units of `pixel_scale`, so that all numbers are about 1.
Eigen::Matrix3d BoardHomography(const std::vector<BoardCorner>& corners, const PinholeCamera& camera,
                                double board_scale, double pixel_scale) {
  HomographyFit fit;
  const Eigen::Vector2d principal(camera.cx, camera.cy);
  for (const BoardCorner& corner : corners) {
    fit.Add(corner.planned.head<2>() / board_scale, (corner.measured.pixel - principal) / pixel_scale);
  }
  return fit.Solve();
}

}  // namespace

std::optional<double> FocalFromBoard(const SfmState& state, int min_corners) {
  const double pixel_scale = 0.5 * std::max(state.camera.width, state.camera.height);
  double squares = 0, products = 0;  // of a * (1 / f^2) + b = 0 over all constraints
  for (const std::vector<BoardCorner>& corners : state.board_corners) {
    if (static_cast<int>(corners.size()) < std::max(8, min_corners)) continue;
    double board_scale = 0;
    for (const BoardCorner& corner : corners) board_scale = std::max(board_scale, corner.planned.head<2>().norm());
    const Eigen::Matrix3d h = BoardHomography(corners, state.camera, board_scale, pixel_scale);
    const Eigen::Vector3d u = h.col(0), v = h.col(1);
    const double a[] = {u.head<2>().dot(v.head<2>()), u.head<2>().squaredNorm() - v.head<2>().squaredNorm()};
    const double b[] = {u.z() * v.z(), u.z() * u.z() - v.z() * v.z()};
    const double scale = 1 / (u.squaredNorm() * v.squaredNorm());
    for (int k = 0; k < 2; ++k) squares += scale * a[k] * a[k], products -= scale * a[k] * b[k];
  }
  if (squares <= 0 || products <= 0) return std::nullopt;
  const double focal = pixel_scale * std::sqrt(squares / products);
  const bool is_a_lens = focal > 0.5 * pixel_scale && focal < 50 * pixel_scale;
  return is_a_lens ? std::optional(focal) : std::nullopt;
}

}  // namespace drupe
