#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "cli/bench/truth_set.h"

namespace drupe {

/// Judges matches by the truth of a set: its poses, and its surface where the set has one.
class MatchTruth {
 public:
  /// A match is wrong when it lies further than this from its epipolar line, in pixels ...
  static constexpr double kMaxEpipolarPx = 2;
  /// ... or further than this from where the surface seen in the first picture appears in the second.
  static constexpr double kMaxSurfacePx = 8;

  /// `set` must outlive the truth. Views are numbered as in set.views. Reads surface.ply when it is there.
  static Result<MatchTruth> Load(const TruthSet& set);

  /// Pixels as detected, with the lens's distortion.
  bool IsWrong(int first, const Eigen::Vector2d& first_px, int second, const Eigen::Vector2d& second_px) const;

  bool has_surface() const { return !layers_.empty(); }

 private:
  /// The front of the surface in one view: per cell of a grid over the picture, the points that fall into it.
  struct Layer {
    int columns = 0;
    std::vector<std::vector<Eigen::Vector3f>> cells;  ///< pixel x, y and depth
  };

  explicit MatchTruth(const TruthSet& set) : set_(&set) {}
  void AddLayer(const Rigid3& cam_from_world, const std::vector<Eigen::Vector3f>& surface);
  /// The depth of the surface at a pixel; nothing where it is not hit squarely.
  std::optional<double> DepthAt(int view, const Eigen::Vector2d& pixel) const;
  double EpipolarPx(int first, const Eigen::Vector2d& first_px, int second, const Eigen::Vector2d& second_px) const;

  const TruthSet* set_;
  std::vector<Layer> layers_;  ///< per view; none without a surface
};

}  // namespace drupe
