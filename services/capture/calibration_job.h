#pragma once

#include <vector>

#include "base/limits.h"
#include "base/run_context.h"
#include "base/status.h"
#include "jobs/job_runner.h"
#include "store/object_store.h"

namespace drupe {

inline constexpr const char* kCalibrateKind = "calibrate";

/// The job behind a calibration: its payload is a CalibrationRequest, its result ToJson(CalibrationResult).
class CalibrationJob {
 public:
  /// `objects` must outlive the job.
  CalibrationJob(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  ObjectStore& objects_;
  const Limits limits_;
};

/// The stages of CalibrationJob with their shares of the progress bar.
std::vector<StageShare> CalibrationStages();

}  // namespace drupe
