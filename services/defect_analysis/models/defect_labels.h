#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "scene/report.h"

namespace drupe {

/// What a person says of one defect of a report.
struct DefectLabel {
  std::string report;                       ///< the report's id; empty: the only report
  int fruit = 0;                            ///< the fruit's number in the report; 0: the only fruit
  int defect = 0;                           ///< the defect's number on the fruit
  std::optional<DefectClass> defect_class;  ///< nothing: it is no defect
  int line = 0;                             ///< of the table, from 1
};

/// Reads a table of labels: CSV with a heading, separated by commas, semicolons or tabs, that has the columns `defect`
/// and `class` (rain_spot, scar, crack, decay, or none for what is no defect) and may have `report` and `fruit`, in any
/// order among others; a report.csv with corrected classes is one. At most 16 MB. Errors: 400 `bad_labels` with the
/// line.
Result<std::vector<DefectLabel>> ParseDefectLabels(std::string_view csv);

/// Writes the labels of a report's id, or without one, into its defects' `class` fields, and takes out of it the
/// defects that no label names and those that are none. Errors: 422 `unknown_defect` with the line of a label whose
/// defect the report has not, or which leaves open on which of its fruits it is.
Status LabelReport(const std::vector<DefectLabel>& labels, Json& report);

}  // namespace drupe
