#include "capture/calibration_job.h"

#include "capture/calibration/calibrate.h"
#include "capture/calibration_request.h"

namespace drupe {

Result<Json> CalibrationJob::operator()(const Job& job, const RunContext& context) const {
  DRUPE_ASSIGN_OR_RETURN(const CalibrationRequest request, ParseCalibrationPayload(job.payload));
  std::vector<PatternPicture> pictures;
  for (const StoredPicture& picture : request.pictures) {
    pictures.push_back({picture.name, [this, sha256 = picture.sha256] { return objects_.Get(sha256); }});
  }
  CalibrationOptions options;
  options.limits = limits_;
  DRUPE_ASSIGN_OR_RETURN(const CalibrationResult result, RunCalibration(pictures, request.pattern, options, context));
  return ToJson(result);
}

std::vector<StageShare> CalibrationStages() {
  return {{"corners", 0.7}, {"calibration", 0.3}};
}

}  // namespace drupe
