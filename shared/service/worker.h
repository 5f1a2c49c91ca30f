#pragma once

#include <string>

#include "http/metrics.h"
#include "jobs/job_runner.h"

namespace drupe {

/// `role`@HOST:PID, which tells the workers of several machines apart.
std::string WorkerName(const std::string& role);

/// Counts the attempts that `options`' runner ends, by kind and outcome, with their wall times and the codes of their
/// errors, and the time that goes into each stage. `metrics` must outlive the runner.
void CountAttempts(Metrics& metrics, JobRunnerOptions& options);

}  // namespace drupe
