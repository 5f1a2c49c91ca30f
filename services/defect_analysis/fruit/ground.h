#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "scene/point_cloud.h"

namespace drupe {

/// The plane that the fruit stands above: the turntable's board. Heights are normal . x - offset, positive on the side
/// of the fruit and the cameras.
struct Ground {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit length
  double offset = 0;                                  ///< in the cloud's unit

  double HeightOf(const Eigen::Vector3f& x) const { return normal.dot(x.cast<double>()) - offset; }
};

/// Looks for the dominant plane of a cloud whose frame is not the board's (RANSAC over a sample of the points, then
/// least squares). `size` is the cloud's diagonal. Nothing when no plane holds at least an eighth of the points, or
/// when points lie on both of its sides alike.
std::optional<Ground> FindGround(const PointCloud& cloud, double size,
                                 const std::vector<Eigen::Vector3d>& camera_centres, std::uint64_t seed);

}  // namespace drupe
