#pragma once

#include <vector>

#include "base/json.h"
#include "base/run_context.h"
#include "capture/scan_run.h"
#include "jobs/job_runner.h"

namespace drupe {

inline constexpr const char* kScanKind = "scan";

/// The handler of scans: takes what is missing and gives {"frames": n}.
class ScanJob {
 public:
  /// `tools` must outlive the runner.
  explicit ScanJob(const ScanTools& tools) : tools_(&tools) {}
  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  const ScanTools* tools_;
};

}  // namespace drupe
