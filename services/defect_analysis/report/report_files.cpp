#include "defect_analysis/report/report_files.h"

#include "defect_analysis/report/defects_ply.h"
#include "defect_analysis/report/observations.h"

namespace drupe {

Result<std::map<std::string, std::string>> MakeReportFiles(const Report& report, const PointCloud& cloud,
                                                           const SparseModel& model,
                                                           const PhotographSource& photographs) {
  std::map<std::string, std::string> files;
  if (photographs) {
    DRUPE_ASSIGN_OR_RETURN(DefectPictures pictures, DrawDefects(report.fruits, model, photographs));
    files = std::move(pictures.files);
  }
  files["report.json"] = DumpJson(ToJson(report), 1);
  files["report.csv"] = ToCsv(report);
  files["observations.json"] = DumpJson(ObservationsJson(report), 1);
  files["defects.ply"] = DefectsPly(cloud, report.fruits);
  return files;
}

}  // namespace drupe
