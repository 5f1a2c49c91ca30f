#pragma once

#include <vector>

#include "base/limits.h"
#include "base/run_context.h"
#include "base/status.h"
#include "capture/calibration_store.h"
#include "jobs/job_runner.h"
#include "store/object_store.h"

namespace drupe {

inline constexpr const char* kCalibrateKind = "calibrate";

/// The job behind a calibration: its payload is a CalibrationRequest, its result ToJson(CalibrationResult) with "id"
/// and "camera" of the stored calibration, and the digest of its coverage picture.
class CalibrationJob {
 public:
  /// All must outlive the job.
  CalibrationJob(ObjectStore& objects, CalibrationStore& calibrations, const Limits& limits)
      : objects_(objects), calibrations_(calibrations), limits_(limits) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  ObjectStore& objects_;
  CalibrationStore& calibrations_;
  const Limits limits_;
};

/// Why the calibration that `job` makes cannot be had: 409 `calibration_not_ready`.
Status CalibrationNotReady(const Job& job);

/// The stages of CalibrationJob with their shares of the progress bar.
std::vector<StageShare> CalibrationStages();

}  // namespace drupe
