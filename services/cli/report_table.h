#pragma once

#include <string>

#include "scene/report.h"

namespace drupe {

/// The report as a table for a terminal: one block a fruit, one line a defect. Without a metric scale, lengths are left
/// out and shares remain.
std::string ReportTable(const Report& report);

}  // namespace drupe
