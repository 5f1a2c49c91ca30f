#pragma once

#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/defect_options.h"
#include "scene/class_model.h"

namespace drupe {

/// What a class is decided by.
struct DefectShape {
  double area_mm2 = 0;
  double elongation = 1;  ///< length / width of the ellipse with the contour's second moments; 1 for a disc
  double length_mm = 0;   ///< full long axis of that ellipse
  double width_mm = 0;    ///< area / length of the contour's long axis
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();  ///< the long axis, unit length, on the map
  double depth_mm = 0;                              ///< below the skin about it
  double depth_uncertainty_mm = 0;
  double lightness_step = 0;   ///< L of the defect minus L of the skin about it
  double skin_lightness = 60;  ///< L of that skin
};

/// Elongation and width from the polygon's second moments on the flat map; the rest is copied.
DefectShape ShapeOf(const Polygon& polygon, double area_mm2, double lightness_step);

/// The rules. Rain spot: compact and small. Decay: compact and large, or half as large and sunk. Crack: elongated,
/// narrow, and dark or sunk. Scar: elongated otherwise (paper 2.1). Dark is what is darker than the skin by the
/// option's step, or on skin that is as dark itself has an L below 30. Sunk is what lies deeper than the option says by
/// three standard uncertainties. The confidence is 0.5 at a threshold, rising to 1 away from it.
Classification Classify(const DefectShape& shape, const ClassOptions& options);

}  // namespace drupe
