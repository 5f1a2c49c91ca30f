#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/rigid3.h"

namespace drupe {

/// A world point and where a view sees it, in normalised image coordinates without distortion.
struct PointCorrespondence {
  Eigen::Vector3d point;
  Eigen::Vector2d xy;
};

struct PoseEstimationOptions {
  double max_error = 0.002;     ///< inlier threshold, normalised image coordinates (pixels / focal length)
  int max_iterations = 2000;    ///< RANSAC samples
  double confidence = 0.99999;  ///< of having drawn one sample without outliers
  std::uint64_t seed = 1;
};

struct PoseEstimate {
  Rigid3 cam_from_world;
  std::vector<std::uint8_t> is_inlier;  ///< one a correspondence
  int inlier_count = 0;
};

/// Pose of a calibrated view: P3P in a locally optimised RANSAC (Chum, Matas & Kittler 2003) with truncated squared
/// errors (Torr & Zisserman 2000), then refined on the inliers. Plane scenes are no special case. Nothing when no
/// sample has 4 inliers.
std::optional<PoseEstimate> EstimatePose(std::span<const PointCorrespondence> correspondences,
                                         const PoseEstimationOptions& options);

/// Levenberg-Marquardt on the reprojection error with a Cauchy loss of scale `loss_scale` (normalised coordinates),
/// over the correspondences marked in `use` (empty: all). Points behind the camera are passed over.
Rigid3 RefinePose(const Rigid3& cam_from_world, std::span<const PointCorrespondence> correspondences,
                  std::span<const std::uint8_t> use, double loss_scale);

}  // namespace drupe
