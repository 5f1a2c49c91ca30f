#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "jobs/job_store.h"

namespace drupe {

struct JobRunnerOptions {
  int workers = 1;                     ///< jobs run at once, 1..256
  int threads_per_job = 0;             ///< RunContext::threads; 0: one per core
  std::int64_t lease_ms = 30'000;      ///< at least 3 heartbeats
  std::int64_t heartbeat_ms = 500;     ///< how often progress is written and a cancel is seen; a new stage at once
  std::int64_t idle_poll_ms = 500;     ///< how often an idle worker looks for retries that became due
  std::int64_t drain_ms = 20'000;      ///< how long Stop lets running jobs go on
  std::string worker_name = "worker";  ///< in Job::worker, followed by the thread's number

  /// Called when an attempt has ended, for metrics: the job as claimed, the handler's outcome, its wall time. Called
  /// from worker threads. Empty: nobody listens.
  std::function<void(const Job& job, const Status& outcome, double wall_s)> on_attempt = nullptr;

  /// Called when a stage of an attempt has ended, for metrics, likewise.
  std::function<void(const Job& job, const std::string& stage, double wall_s)> on_stage = nullptr;

  Status Check() const;
};

/// A stage's share of a job's progress bar, in the order of the stages; the shares are normalised to sum 1.
struct StageShare {
  std::string stage;
  double share = 1;
};

/// Runs jobs of a JobStore on threads of this process.
///
/// A handler computes a job's result from its payload and nothing else, so that a repetition gives the same. It must
/// report and obey the RunContext. Its outcome ends the attempt:
///   - a value: succeeded;
///   - kCancelled: cancelled if the user asked, given back if the runner is draining;
///   - kInternal, kDataLoss, kUnavailable, kTooManyRequests, kInsufficientStorage, or an exception: retried with
///   backoff;
///   - any other error: failed for good, since the same input would fail again.
class JobRunner {
 public:
  using Handler = std::function<Result<Json>(const Job& job, const RunContext& context)>;

  /// `store` must outlive the runner.
  JobRunner(JobStore& store, const JobRunnerOptions& options);
  /// Stops with the drain time of the options.
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Registers the handler of a kind, before Start. `stages` maps the handler's per-stage fractions to Job::progress;
  /// empty: a reported fraction is the job's progress.
  void Handle(const std::string& kind, Handler handler, std::vector<StageShare> stages = {});
  /// Errors: 400 for bad options.
  Status Start();
  /// Takes no more jobs, waits up to drain_ms for the running ones, then gives them back to the store (their attempt
  /// does not count) and tells their handlers to stop. Returns when all threads have ended.
  void Stop();
  void Stop(std::int64_t drain_ms);

  /// Jobs running now.
  int active() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace drupe
