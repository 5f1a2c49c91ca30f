#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "base/status.h"
#include "reconstruction/dense/dense.h"
#include "reconstruction/dense/view_pyramid.h"

namespace drupe::dense {

/// Where surface is looked for: a box in the world, or everything.
struct RegionOfInterest {
  std::optional<Eigen::AlignedBox3d> box;

  bool Contains(const Eigen::Vector3d& point) const { return !box || box->contains(point); }
};

/// For a fruit above a board: a box around the tracks that lie above the board, enlarged, since the tracks do not reach
/// the fruit's outline. Otherwise everything. Errors: 422 `no_seeds`.
Result<RegionOfInterest> FindRegionOfInterest(const SparseModel& model, const DenseOptions& options);

/// The part of the undistorted picture that shows the region; empty when the view does not see it.
PixelRect ProjectRegion(const RegionOfInterest& region, const PinholeCamera& camera, const Rigid3& cam_from_world);

}  // namespace drupe::dense
