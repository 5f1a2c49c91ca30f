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
  DRUPE_ASSIGN_OR_RETURN(const std::string png, DrawCoverage(result.coverage));
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo picture, objects_.Put(png));
  const Json calibration = ToJson(result.calibration);
  const std::string id = CalibrationId(calibration, request.camera);
  DRUPE_RETURN_IF_ERROR(calibrations_.Put({id, job.id, calibration, request.camera, picture.sha256}));
  Json json = ToJson(result);
  json["id"] = id;
  json["camera"] = ToJson(request.camera);
  json["coverage_sha256"] = picture.sha256;
  return json;
}

Status CalibrationNotReady(const Job& job) {
  return {StatusKind::kConflict, "calibration_not_ready",
          std::string("there is no calibration: its state is ") + JobStateName(job.state), "calibration"};
}

std::vector<StageShare> CalibrationStages() {
  return {{"corners", 0.7}, {"calibration", 0.3}};
}

}  // namespace drupe
