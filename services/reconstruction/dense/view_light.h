#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "reconstruction/dense/surface_grid.h"

namespace drupe::dense {

/// What one view shows of a sampled point.
struct LightSample {
  std::uint32_t point = 0;  ///< looks at one point follow one another
  std::int32_t view = 0;
  float weight = 0;                                    ///< > 0
  Eigen::Array3f log_colour = Eigen::Array3f::Zero();  ///< with the shading taken out
};

/// By how much a place on the surface is brighter or darker in one view than in the others: shadows of what stands
/// near, light that it throws back, gloss, and what the model of the shading misses. The lamps stand still while the
/// fruit turns, so all of these move over the skin. One smooth field over the surface for each view, in logarithms of
/// colour, such that over every place the views' colours agree once it is taken out: for points p, views v and colours
/// a_p of the skin it minimises
///   sum w (y_pv - a_p - f_v(p))^2 + smoothness of each f_v + the size of f,
/// where residuals and sizes beyond a few hundredths count linearly (Huber 1964). What all views see alike stays in the
/// skin's colour; a point's colour no longer depends on which views happen to see it.
class ViewLight {
 public:
  ViewLight() = default;  ///< none

  /// `positions[sample.point]` is where a sample lies; views are 0 .. view_count - 1. `grid` must outlive the result's
  /// use of its places.
  static ViewLight Fit(const SurfaceGrid& grid, const std::vector<Eigen::Vector3f>& positions,
                       const std::vector<LightSample>& samples, int view_count);

  /// The field of a view, 0 where nothing of it is known.
  Eigen::Array3f Log(const SurfaceGrid::Place& place, int view) const;

 private:
  int view_count_ = 0;
  std::vector<std::int32_t> fields_;    ///< [cell * view_count + view]: index in values_, or -1
  std::vector<Eigen::Array3f> values_;  ///< of the cells' middles
};

}  // namespace drupe::dense
