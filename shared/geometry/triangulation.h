#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "geometry/rigid3.h"

namespace drupe {

/// One ray to a point: where the camera is and the normalised image coordinates (x/z, y/z) at which it sees the point.
struct RayObservation {
  Rigid3 cam_from_world;
  Eigen::Vector2d xy;
};

/// The point with least squared distance from the rays of two observations or more, then with least squared
/// reprojection error (Gauss-Newton). Nothing when the rays are parallel or the point lies behind a camera.
std::optional<Eigen::Vector3d> Triangulate(std::span<const RayObservation> observations);

/// Distance in normalised image coordinates between the observation and the point's projection; infinity behind it.
double ReprojectionError(const RayObservation& observation, const Eigen::Vector3d& point);

/// Cosine of the largest angle at `point` between two of the camera centres; 1 for fewer than two.
double SmallestRayCosine(std::span<const RayObservation> observations, const Eigen::Vector3d& point);

}  // namespace drupe
