#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/status.h"
#include "defect_analysis/defects/defect_options.h"
#include "scene/report.h"

namespace drupe {

/// The plane of a defect (paper 4.2 (1), Figures 9 and 10): RANSAC with `iterations` trials and an inlier distance of
/// `distance_mm`, or `distance` times the points' extent, but at least `noise_mm`, then least squares over the inliers.
/// `outward` gives the normal its sign; planes that lean from it by more than 60 degrees are none of the skin.
/// mean_abs_z_mm is over all points, after rotation into the plane. Errors: 422 `degenerate_plane` for fewer than 3
/// points, points on a line, or no such plane.
Result<DefectPlane> FitDefectPlane(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& outward,
                                   double noise_mm, const PlaneOptions& options, std::uint64_t seed);

}  // namespace drupe
