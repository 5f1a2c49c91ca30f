#pragma once

#include "base/json.h"
#include "scene/report.h"

namespace drupe {

/// The measures in the form that PlantCV writes its results in ("observations" by sample, each {"trait", "method",
/// "scale", "datatype", "value", "label"}), for programs that read that: the samples are fruit_1, fruit_1_defect_1 and
/// so on. Without a metric scale what is measured in mm is left out.
Json ObservationsJson(const Report& report);

}  // namespace drupe
