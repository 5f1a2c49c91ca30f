#pragma once

#include <vector>

#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// One defect's outline and the field it was traced in.
struct Outline {
  Polygon polygon;
  const TransitionField* field = nullptr;  ///< Outlines::fields owns it
  double disputed_mm2 = 0;                 ///< between the field's half-way line and the local one
  bool completed = false;                  ///< part of it lies under another defect and was completed
};

struct Outlines {
  std::vector<TransitionField> fields;  ///< one a colour
  std::vector<Outline> outlines;        ///< largest first within a colour
};

/// The outlines of the defects in a patch: the half-way line of the field; where the patch holds two colours that each
/// draw an outline of their own, the half-way lines of the two layers; and where an outline has a neck, its parts. What
/// another defect covers of a roundish one is completed. `threshold`: Segmentation::threshold.
Outlines SeparateDefects(TransitionField field, double threshold, const DefectOptions& options);

}  // namespace drupe
