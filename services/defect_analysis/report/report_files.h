#pragma once

#include <map>
#include <string>

#include "base/status.h"
#include "defect_analysis/report/defect_pictures.h"
#include "scene/point_cloud.h"
#include "scene/report.h"
#include "scene/sparse_model.h"

namespace drupe {

/// Everything that belongs to a report, by file name: report.json, report.csv, observations.json, defects.ply, and,
/// when there are photographs, contact_sheet.png and defect_FRUIT_DEFECT.png. `photographs` may be empty. Errors:
/// those of DrawDefects.
Result<std::map<std::string, std::string>> MakeReportFiles(const Report& report, const PointCloud& cloud,
                                                           const SparseModel& model,
                                                           const PhotographSource& photographs);

}  // namespace drupe
