#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "scene/report.h"

namespace drupe {

/// A defect that truly is on a fruit: rendered or made up.
struct TrueDefect {
  DefectClass defect_class = DefectClass::kRainSpot;
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();  ///< on the skin, board frame
  double area_mm2 = 0;                                  ///< on the curved skin, what another defect covers included
  double perimeter_mm = 0;                              ///< on the skin; 0 when it is not known
  double stretch = 1;                                   ///< length over width
  bool touching = false;                                ///< it touches or overlaps another defect
  std::optional<double> lightness_step{};               ///< L of the defect minus L of the skin, where it is known
};

/// What is true of one fruit; 0 stands for what is not known.
struct FruitTruth {
  DefectClass grade = DefectClass::kIntact;
  Eigen::Vector3d centre_mm = Eigen::Vector3d::Zero();
  double volume_mm3 = 0;
  double surface_area_mm2 = 0;
  double equatorial_diameter_mm = 0;
  std::vector<TrueDefect> defects;
};

}  // namespace drupe
