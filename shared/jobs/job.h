#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// queued -> running -> succeeded | failed | cancelled; running -> queued on a retry, a lost lease or a drain.
enum class JobState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };
const char* JobStateName(JobState state);  ///< "queued", "running", "succeeded", "failed", "cancelled"
/// Errors: 400 `invalid_state`.
Result<JobState> ParseJobState(std::string_view name);
/// True for succeeded, failed and cancelled, which a job never leaves by itself.
bool IsTerminal(JobState state);

/// Why a job, or one attempt at it, failed.
struct JobError {
  std::string code;     ///< that of the Status, or "attempts_exhausted", "lease_expired", "owner_died"
  std::string message;  ///< for the user
  std::string field;    ///< the input it is about; may be empty

  bool operator==(const JobError&) const = default;
};

/// What is asked for.
struct JobSpec {
  std::string kind = "";          ///< chooses the handler: "reconstruct", "analyze", ...
  std::string id_prefix = "job";  ///< the job's id is NewId(id_prefix)
  std::string subject = "";       ///< what the job is about (an id), for JobFilter; may be empty
  Json payload = Json::object();
  int priority = 0;                  ///< higher first; equal ones in order of submission
  std::string idempotency_key = "";  ///< empty: every Submit is a new job
  int max_attempts = 3;              ///< 1..100 attempts that may end in a failure or a lost lease

  /// Errors: 400 with the field that is out of range.
  Status Check() const;
};

/// A job as the store knows it.
struct Job {
  std::string id;
  std::string kind;
  std::string subject;
  Json payload;
  int priority = 0;
  std::string idempotency_key;
  JobState state = JobState::kQueued;
  bool cancel_requested = false;  ///< a running job that should stop
  std::string stage;              ///< of the current attempt
  double progress = 0;            ///< 0..1, of the whole job; 1 when succeeded
  std::int64_t attempt = 0;       ///< number of the latest claim, the fencing token; never decreases
  int failures = 0;               ///< attempts that counted against max_attempts
  int max_attempts = 3;
  std::string worker;                ///< that claimed it last
  std::string trace;                 ///< of the request that submitted it (CurrentTrace)
  std::int64_t lease_until_ms = 0;   ///< while running
  std::int64_t available_at_ms = 0;  ///< a queued job is not claimed before
  std::int64_t created_ms = 0;
  std::int64_t started_ms = 0;    ///< of the latest attempt; 0 before the first
  std::int64_t finished_ms = 0;   ///< 0 until terminal
  std::optional<Json> result;     ///< when succeeded
  std::optional<JobError> error;  ///< of the latest failed attempt; when dead, why it is dead
};

/// One change of state.
struct JobEvent {
  std::int64_t at_ms = 0;
  JobState state = JobState::kQueued;
  std::int64_t attempt = 0;
  std::string worker;
  std::string reason;  ///< "submitted", "claimed", "retry: CODE", "lease_expired", "released", ...
};

struct JobFilter {
  std::string kind = "";                         ///< empty: all
  std::string subject = "";                      ///< empty: all
  std::optional<JobState> state = std::nullopt;  ///< absent: all
};

struct JobPage {
  std::vector<Job> jobs;    ///< newest first
  std::string next_cursor;  ///< empty: this was the last page
};

/// How many jobs there are in each state, for metrics and admission.
struct JobCounts {
  std::int64_t queued = 0, running = 0, succeeded = 0, failed = 0, cancelled = 0;
  std::int64_t oldest_queued_ms = 0;  ///< creation time of the oldest queued job; 0 when none
};

}  // namespace drupe
