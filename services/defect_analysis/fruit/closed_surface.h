#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/status.h"
#include "defect_analysis/fruit/fruit_options.h"
#include "scene/fruit_cloud.h"

namespace drupe {

/// A closed surface through the points of one object.
struct ClosedSurface {
  FruitSurface surface;
  double residual_mm = 0;     ///< robust standard deviation of the cells' radii about it
  double observed_share = 0;  ///< of its area, 0..1
};

/// Fits the distance to the skin as a function of direction: spherical harmonics of rising degree through the median
/// radius of each cell of directions, re-weighted by Tukey's biweight, which drops the needle and stray points. What no
/// view saw (the underside) is closed by the mirror image of the opposite side about the equator across `up`, all but
/// its pole, at a small weight, joined to the seen skin by the continuation of least bending (FitSphericalFunction).
/// Errors: 422 `not_a_fruit` when the points do not surround a centre.
Result<ClosedSurface> FitClosedSurface(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& up,
                                       const FruitOptions& options);

/// Least-squares sphere re-weighted against outliers; nothing is assumed about the share of the sphere that is seen.
struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
};
Result<Sphere> FitSphere(const std::vector<Eigen::Vector3d>& points);

}  // namespace drupe
