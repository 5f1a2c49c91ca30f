#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "jobs/change_signal.h"
#include "jobs/job.h"

namespace drupe {

struct JobStoreOptions {
  /// The n-th failure of a job keeps it back for min(first * 2^(n-1), max).
  std::int64_t first_backoff_ms = 1'000;
  std::int64_t max_backoff_ms = 60'000;
  std::int64_t max_queued = 10'000;         ///< Submit refuses beyond: 503 `queue_full`
  std::size_t max_payload_bytes = 1 << 20;  ///< of payload and of result, as JSON text

  Status Check() const;
  /// Milliseconds to wait after the n-th failure, n >= 1.
  std::int64_t BackoffMs(int failures) const;
};

/// What a worker reports while it runs a job.
struct Heartbeat {
  std::string stage = "";
  double progress = 0;  ///< 0..1 of the whole job
  std::int64_t lease_ms = 30'000;
};

/// Jobs that survive the processes which run them: at least once, each ended exactly once.
///
/// A claim gives a job to one worker for `lease_ms` under a new attempt number. Everything a worker says afterwards
/// names that number; once the lease has run out and the job went to somebody else, or was ended, it is refused with
/// 409 `stale_attempt`, so a worker that was paused or cut off cannot overwrite a later outcome.
///
/// Submit, Complete, Fail, Cancel, MarkCancelled, Release and Retry are durable when they return. Thread-safe.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Adds a job. With an idempotency key that is known, returns the job it made then; if kind, subject or payload
  /// differ: 409 `idempotency_key_reused`. Errors: 400 as JobSpec::Check, 413 `payload_too_large`, 503 `queue_full`.
  virtual Result<Job> Submit(const JobSpec& spec) = 0;
  /// Errors: 404 `job_not_found`, as in every call below that takes an id.
  virtual Result<Job> Get(std::string_view id) = 0;
  /// Newest first. `limit` 1..1000; `cursor` empty for the first page. Errors: 400 `invalid_cursor`, `invalid_limit`.
  virtual Result<JobPage> List(const JobFilter& filter, int limit, const std::string& cursor) = 0;
  /// Changes of state, oldest first.
  virtual Result<std::vector<JobEvent>> History(std::string_view id) = 0;
  virtual Result<JobCounts> Counts() = 0;

  /// Takes the first available job of one of `kinds`, or none. Leases that ran out are expired first.
  virtual Result<std::optional<Job>> Claim(const std::vector<std::string>& kinds, const std::string& worker,
                                           std::int64_t lease_ms) = 0;
  /// Extends the lease and records progress. Returns true when the job should stop because somebody cancelled it.
  virtual Result<bool> Beat(std::string_view id, std::int64_t attempt, const Heartbeat& heartbeat) = 0;
  virtual Status Complete(std::string_view id, std::int64_t attempt, const Json& result) = 0;
  /// Ends an attempt. Retryable: queued again after the backoff, or failed with `attempts_exhausted` when the last
  /// attempt is used up. A job whose cancel was requested becomes cancelled instead of being retried.
  virtual Status Fail(std::string_view id, std::int64_t attempt, const JobError& error, bool retryable) = 0;
  /// Ends an attempt that stopped because of a cancel.
  virtual Status MarkCancelled(std::string_view id, std::int64_t attempt) = 0;
  /// Gives a job back, to be claimed at once; the attempt does not count as a failure.
  virtual Status Release(std::string_view id, std::int64_t attempt) = 0;

  /// Cancels a queued job at once and asks a running one to stop. A job already cancelled is fine. Returns the job.
  /// Errors: 409 `job_finished` when it has succeeded or failed.
  virtual Result<Job> Cancel(std::string_view id) = 0;
  /// Queues a failed or cancelled job again, with all its attempts. Errors: 409 `job_not_ended`.
  virtual Result<Job> Retry(std::string_view id) = 0;
  /// Ends the attempts whose lease has run out, as Fail does with `lease_expired`; returns how many.
  virtual Result<int> ExpireLeases() = 0;
  /// Forgets up to `limit` jobs of `kinds` (empty: of all) that ended before `ended_ms`, with their history and their
  /// idempotency keys; returns how many.
  virtual Result<int> DeleteEndedBefore(std::int64_t ended_ms, int limit,
                                        const std::vector<std::string>& kinds = {}) = 0;

  /// Advances with every change to any job, progress included.
  ChangeSignal& changes() { return changes_; }

 protected:
  ChangeSignal changes_;
};

}  // namespace drupe
