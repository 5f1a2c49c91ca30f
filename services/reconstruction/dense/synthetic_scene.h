#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "image/image.h"
#include "scene/sparse_model.h"

namespace drupe::dense {

/// The ball of MakeBallScene, in mm.
const Eigen::Vector3d kBallCentre(0, 0, 25);
constexpr double kBallRadius = 12;

/// Rendered scenes for the tests of this folder.
struct SyntheticScene {
  SparseModel model;
  std::vector<RgbImage> pictures;  ///< of model.views
};

/// Where a ray meets the scene's surface; nothing when it misses.
using SurfaceHit =
    std::function<std::optional<Eigen::Vector3d>(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;

/// A smooth texture of the world, 0..1, with detail of a few millimetres.
double TextureAt(const Eigen::Vector3d& point);

/// A camera at `position` that looks at `target`, z of the world up in the picture.
Rigid3 LookingAt(const Eigen::Vector3d& position, const Eigen::Vector3d& target);

/// Renders every view of the model.
std::vector<RgbImage> Render(const SparseModel& model, const SurfaceHit& hit);

/// A textured ball of radius 12 about (0, 0, 25) on an imagined board, seen from a ring of 24 views, with tracks that
/// lie within 0.1 of the surface.
SyntheticScene MakeBallScene();

}  // namespace drupe::dense
