#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "geometry/pinhole_camera.h"
#include "image/image.h"

namespace drupe {

/// Measures the corners of square markers at full resolution.
///
/// Each side is crossed by short profiles along its normal. The edge on a profile is where the area under it splits
/// into two plateaus (the grey-level moment edge of Tabatabai & Mitchell 1984), which symmetric blur does not move. A
/// line is fitted robustly to the edges of a side, in coordinates without lens distortion (a 200 pixel side bends by
/// 0.1 pixel at the border of a 4K picture), and corners are intersections of neighbouring lines.
class MarkerRefiner {
 public:
  /// Borrows picture and camera. `image` is grey; markers have `bits` x `bits` cells inside a border of one cell.
  MarkerRefiner(const GrayImage& image, const PinholeCamera& camera, int bits)
      : image_(image), camera_(camera), cells_a_side_(bits + 2) {}

  /// Corners in pixels, from corners that are at most `uncertainty_px` wrong, in the same order. Nothing when a side is
  /// hidden, out of the picture or not straight.
  std::optional<std::array<Eigen::Vector2d, 4>> Refine(const std::array<Eigen::Vector2d, 4>& corners,
                                                       double uncertainty_px) const;

 private:
  /// How far a profile looks for the edge, and how far the two plateaus beside the edge are taken to be flat.
  struct Reach {
    double search_px;
    double plateau_px;
  };
  /// A line n . x = d in normalised coordinates.
  struct Line {
    Eigen::Vector2d normal;
    double offset;
  };

  std::optional<Line> MeasureSide(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                  const Eigen::Vector2d& outward, const Reach& reach) const;
  std::optional<std::array<Eigen::Vector2d, 4>> RefineOnce(const std::array<Eigen::Vector2d, 4>& corners,
                                                           const Reach& reach) const;
  std::optional<double> FindEdge(const Eigen::Vector2d& centre, const Eigen::Vector2d& direction,
                                 const Reach& reach) const;

  const GrayImage& image_;
  const PinholeCamera& camera_;
  int cells_a_side_;
};

}  // namespace drupe
