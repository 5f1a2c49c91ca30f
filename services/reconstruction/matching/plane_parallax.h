#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <random>
#include <span>

#include "reconstruction/matching/epipolar.h"
#include "reconstruction/matching/ransac.h"

namespace drupe {

/// The homography under which five or more of a seven-point sample lie in one plane, if there is one: then the sample's
/// fundamental matrix is arbitrary but for that plane (Chum, Werner & Matas 2005). The plane is sought through the
/// triplets of which any five points hold one; a point is in it within twice `max_error`.
std::optional<Eigen::Matrix3d> PlaneOfSample(const Eigen::Matrix3d& fundamental, const std::array<PointPair, 7>& sample,
                                             double max_error);

/// The fundamental matrix of a plane, refined over all pairs that it holds, and two pairs off it (plane and parallax),
/// by RANSAC over these two. Nothing when fewer than two pairs are off the plane.
std::optional<Eigen::Matrix3d> CompletePlane(const Eigen::Matrix3d& plane, std::span<const PointPair> pairs,
                                             const RansacOptions& options, std::mt19937_64& random);

}  // namespace drupe
