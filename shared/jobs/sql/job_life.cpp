#include "jobs/sql/job_life.h"

#include <limits>
#include <string>

namespace drupe {

namespace {

Result<JobRow> Found(Result<std::optional<JobRow>> row, std::string_view id) {
  if (!row.ok()) return row.status();
  if (!row->has_value()) return NotFound("job_not_found", "there is no job " + std::string(id));
  return std::move(**row);
}

}  // namespace

Result<JobRow> JobLife::Find(std::string_view id) {
  return Found(rows_.FindById(id), id);
}

Result<JobRow> JobLife::Take(std::string_view id) {
  return Found(rows_.TakeById(id), id);
}

Result<JobRow> JobLife::TakeAttempt(std::string_view id, std::int64_t attempt) {
  DRUPE_ASSIGN_OR_RETURN(JobRow row, Take(id));
  if (row.job.state == JobState::kRunning && row.job.attempt == attempt) return row;
  return Status(StatusKind::kConflict, "stale_attempt",
                "attempt " + std::to_string(attempt) + " of job " + row.job.id + " is over: the job is " +
                    JobStateName(row.job.state) + " at attempt " + std::to_string(row.job.attempt));
}

Status JobLife::Move(JobRow& row, JobState state, std::string_view reason) {
  const std::int64_t now = clock_.NowMs();
  row.job.state = state;
  row.job.lease_until_ms = state == JobState::kRunning ? row.job.lease_until_ms : 0;
  row.job.finished_ms = IsTerminal(state) ? now : 0;
  DRUPE_RETURN_IF_ERROR(rows_.Update(row));
  return rows_.AddEvent(row, reason, now);
}

Status JobLife::Fail(JobRow& row, const JobError& error, bool retryable, Backoff backoff) {
  Job& job = row.job;
  ++job.failures;
  job.error = error;
  if (job.cancel_requested) return Move(row, JobState::kCancelled, "cancelled");
  if (!retryable) return Move(row, JobState::kFailed, "failed: " + error.code);
  if (job.failures >= job.max_attempts) {
    job.error = JobError{"attempts_exhausted",
                         "given up after " + std::to_string(job.failures) + " attempts; the last ended with " +
                             error.code + ": " + error.message,
                         error.field};
    return Move(row, JobState::kFailed, "attempts_exhausted: " + error.code);
  }
  job.available_at_ms = clock_.NowMs() + (backoff == Backoff::kYes ? options_.BackoffMs(job.failures) : 0);
  return Move(row, JobState::kQueued, "retry: " + error.code);
}

Result<int> JobLife::ExpireLeases() {
  return FailAll(clock_.NowMs(), {"lease_expired", "the worker stopped reporting", ""}, Backoff::kYes);
}

Result<int> JobLife::RecoverRunning() {
  return FailAll(std::numeric_limits<std::int64_t>::max(),
                 {"owner_died", "the service stopped while it ran this job", ""}, Backoff::kNo);
}

Result<int> JobLife::FailAll(std::int64_t lease_before_ms, const JobError& error, Backoff backoff) {
  DRUPE_ASSIGN_OR_RETURN(std::vector<JobRow> rows, rows_.TakeExpired(lease_before_ms));
  for (JobRow& row : rows) DRUPE_RETURN_IF_ERROR(Fail(row, error, true, backoff));
  return static_cast<int>(rows.size());
}

}  // namespace drupe
