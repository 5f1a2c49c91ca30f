#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "defect_analysis/defects/patches.h"
#include "defect_analysis/defects/skin_chart.h"
#include "defect_analysis/defects/skin_map.h"

namespace drupe {

/// How far the skin's colour has gone from healthy (0) to defective (1) around one patch, on a regular grid of a flat
/// map of the skin. Node (column, row) lies at origin + step * (column, row), mm.
struct TransitionField {
  SkinChart chart;
  int width = 0, height = 0;
  double step = 0;
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  std::vector<float> level{};             ///< row by row; 0 where no point is near
  std::vector<float> full_level{};        ///< the same before it is limited to the patch's reach
  std::vector<std::int32_t> inside{};     ///< 1 where the node lies in the patch, -1 in another one, else 0
  std::vector<Eigen::Vector3f> change{};  ///< mean of colour / healthy colour - 1, linear light; 0 beyond the reach
  Eigen::Vector3f change_noise = Eigen::Vector3f::Ones();  ///< standard deviation of one point of healthy skin in it
  double blur = 0;                                         ///< standard deviation of the resampling's Gauss kernel, mm
  double noise = 0;                                        ///< standard deviation of one point's level
  double spacing = 0;                                      ///< of the points: one a spacing squared
  Eigen::Vector3d healthy_linear = Eigen::Vector3d::Zero();  ///< linear light of the skin about the patch
  Eigen::Vector3d defect_linear = Eigen::Vector3d::Zero();   ///< of the patch's core
  Eigen::Vector3d healthy_lab = Eigen::Vector3d::Zero();     ///< of the skin about the patch
  Eigen::Vector3d defect_lab = Eigen::Vector3d::Zero();      ///< of the patch's core
  int points = 0;                                            ///< in the patch

  Eigen::Vector2d FlatOf(double column, double row) const { return origin + step * Eigen::Vector2d(column, row); }
  /// A value of every node (level, full_level), interpolated at a place on the map; outside, that of the grid's rim.
  double ValueAt(const std::vector<float>& values, const Eigen::Vector2d& flat) const;
  /// How steeply the level falls at a place, per mm, taken over the kernel's width.
  double SlopeAt(const Eigen::Vector2d& flat) const;
};

/// Resamples the points about a patch. The level is the colour's place on the line from the healthy to the defective
/// colour, in linear light, where blur by lens and averaging is symmetric, so that the half-way level lies on the true
/// boundary however soft the transition looks. The healthy colour follows the shading as an affine function fitted to
/// the skin around the patch; the defective one is that of the patch's core, shaded like the skin. Farther than
/// a transition's width from the patch the level is 0. `patch_of` is FindPatches'. Nothing when too few points are
/// there to tell the two colours.
std::optional<TransitionField> BuildTransitionField(const FruitCloud& fruit, const SkinMap& map, const Patch& patch,
                                                    int patch_number, const std::vector<std::int32_t>& patch_of);

}  // namespace drupe
