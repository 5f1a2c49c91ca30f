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

/// The outlines of two defects that touch in a patch, of two colours which each draw an outline of their own and would
/// each stand out alone; empty where the patch holds no such two. `threshold`: Segmentation::threshold.
Outlines SeparateLayers(const TransitionField& field, double threshold, const DefectOptions& options);

/// The outlines of the defects in a patch: the half-way line of the field; where SeparateLayers finds two, theirs; and
/// where an outline has a neck, its parts. What another defect covers of a roundish one is completed.
Outlines SeparateDefects(TransitionField field, double threshold, const DefectOptions& options);

}  // namespace drupe
