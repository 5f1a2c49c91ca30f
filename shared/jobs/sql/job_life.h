#pragma once

#include <cstdint>
#include <string_view>

#include "base/clock.h"
#include "base/status.h"
#include "jobs/job_store.h"
#include "jobs/sql/job_rows.h"

namespace drupe {

/// Whether a failed attempt holds the job back before the next one.
enum class Backoff { kYes, kNo };

/// The rules by which jobs change state. Every change is saved together with an event of the history. All calls are
/// made inside a transaction.
class JobLife {
 public:
  /// All of them must outlive this object.
  JobLife(JobRows& rows, const JobStoreOptions& options, const Clock& clock)
      : rows_(rows), options_(options), clock_(clock) {}

  /// Errors: 404 `job_not_found`.
  Result<JobRow> Find(std::string_view id);
  /// As Find, to change it: nobody else changes it until the transaction ends.
  Result<JobRow> Take(std::string_view id);
  /// As Take, of a running attempt. Errors: 404 `job_not_found`, 409 `stale_attempt` when that attempt is over.
  Result<JobRow> TakeAttempt(std::string_view id, std::int64_t attempt);

  /// Moves a job to `state`; `reason` goes into the history.
  Status Move(JobRow& row, JobState state, std::string_view reason);
  /// Ends an attempt without success: queued again, failed, or cancelled where that was asked for.
  Status Fail(JobRow& row, const JobError& error, bool retryable, Backoff backoff);
  /// Fails the attempts whose lease has run out; returns how many.
  Result<int> ExpireLeases();
  /// Fails all running attempts, because their process is no more; returns how many.
  Result<int> RecoverRunning();

 private:
  Result<int> FailAll(std::int64_t lease_before_ms, const JobError& error, Backoff backoff);

  JobRows& rows_;
  const JobStoreOptions& options_;
  const Clock& clock_;
};

}  // namespace drupe
