#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "scene/class_model.h"

namespace drupe {

/// A defect whose class a person has seen to.
struct LabelledDefect {
  ClassFeatures features = ClassFeatures::Zero();
  DefectClass defect_class = DefectClass::kRainSpot;
};

/// The defects of one report, all of whose `class` fields are taken as the truth: someone has corrected them, and has
/// deleted what is no defect. Limits: 100 fruits with 10,000 defects each. Errors: 400 `bad_report` with the field that
/// is missing or wrong, 422 `no_scale` for a report that is not in mm.
Result<std::vector<LabelledDefect>> ReadLabelledReport(const Json& report);

}  // namespace drupe
