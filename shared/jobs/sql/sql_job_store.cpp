#include "jobs/sql/sql_job_store.h"

#include <algorithm>
#include <functional>

#include "base/ids.h"
#include "base/log.h"
#include "base/trace.h"
#include "jobs/sql/job_life.h"
#include "jobs/sql/job_rows.h"
#include "jobs/sql/page_cursor.h"

namespace drupe {

namespace {

constexpr int kMaxPage = 1000;

Status Conflict(std::string code, std::string message) {
  return {StatusKind::kConflict, std::move(code), std::move(message)};
}

/// Equality of JSON values, whatever the order of keys.
bool SameJson(const Json& a, const Json& b) {
  return nlohmann::json(a) == nlohmann::json(b);
}

Job NewJob(const JobSpec& spec, std::int64_t now_ms) {
  Job job;
  job.id = NewId(spec.id_prefix);
  job.kind = spec.kind;
  job.subject = spec.subject;
  job.payload = spec.payload;
  job.priority = spec.priority;
  job.idempotency_key = spec.idempotency_key;
  job.max_attempts = spec.max_attempts;
  job.trace = CurrentTrace();
  job.created_ms = job.available_at_ms = now_ms;
  return job;
}

class SqlJobStore : public JobStore {
 public:
  SqlJobStore(Database& database, const JobStoreOptions& options, const Clock& clock)
      : database_(database), rows_(database), options_(options), clock_(clock), life_(rows_, options_, clock_) {}

  ~SqlJobStore() override { database_.OnAnnouncement({}); }

  Status Open() {
    DRUPE_RETURN_IF_ERROR(options_.Check());
    DRUPE_RETURN_IF_ERROR(rows_.Migrate());
    if (!database_.IsShared()) return Recover();
    database_.OnAnnouncement([this] { changes_.Notify(); });
    return Status::Ok();
  }

  Result<Job> Submit(const JobSpec& spec) override;
  Result<Job> Get(std::string_view id) override;
  Result<JobPage> List(const JobFilter& filter, int limit, const std::string& cursor) override;
  Result<std::vector<JobEvent>> History(std::string_view id) override;
  Result<JobCounts> Counts() override;
  Result<std::optional<Job>> Claim(const std::vector<std::string>& kinds, const std::string& worker,
                                   std::int64_t lease_ms) override;
  Result<bool> Beat(std::string_view id, std::int64_t attempt, const Heartbeat& heartbeat) override;
  Status Complete(std::string_view id, std::int64_t attempt, const Json& result) override;
  Status Fail(std::string_view id, std::int64_t attempt, const JobError& error, bool retryable) override;
  Status MarkCancelled(std::string_view id, std::int64_t attempt) override;
  Status Release(std::string_view id, std::int64_t attempt) override;
  Result<Job> Cancel(std::string_view id) override;
  Result<Job> Retry(std::string_view id) override;
  Result<int> ExpireLeases() override;
  Result<int> DeleteEndedBefore(std::int64_t ended_ms, int limit, const std::vector<std::string>& kinds) override;

 private:
  /// Transaction that tells the waiters when it has changed something.
  Status Change(Durability durability, const std::function<Status()>& body);
  /// Runs `end` on the row of a running attempt, durably.
  Status EndAttempt(std::string_view id, std::int64_t attempt, const std::function<Status(JobRow&)>& end);
  Result<Job> FindOrInsert(const JobSpec& spec);
  Status CheckSize(std::size_t bytes, std::string_view what) const;
  Status Recover();

  Database& database_;
  JobRows rows_;
  const JobStoreOptions options_;
  const Clock& clock_;
  JobLife life_;
};

Status SqlJobStore::Change(Durability durability, const std::function<Status()>& body) {
  const Status changed = database_.Transaction(durability, [&] {
    const Status done = body();
    return done.ok() ? database_.Announce() : done;
  });
  if (changed.ok()) changes_.Notify();
  return changed;
}

Status SqlJobStore::CheckSize(std::size_t bytes, std::string_view what) const {
  if (bytes <= options_.max_payload_bytes) return Status::Ok();
  return {StatusKind::kTooLarge, std::string(what) + "_too_large",
          "the " + std::string(what) + " has " + std::to_string(bytes) + " bytes as JSON; the limit is " +
              std::to_string(options_.max_payload_bytes)};
}

// ---- what a client asks

Result<Job> SqlJobStore::Submit(const JobSpec& spec) {
  DRUPE_RETURN_IF_ERROR(spec.Check());
  DRUPE_RETURN_IF_ERROR(CheckSize(DumpJson(spec.payload).size(), "payload"));
  Job job;
  DRUPE_RETURN_IF_ERROR(Change(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(job, FindOrInsert(spec));
    return Status::Ok();
  }));
  return job;
}

Result<Job> SqlJobStore::FindOrInsert(const JobSpec& spec) {
  if (!spec.idempotency_key.empty()) {
    DRUPE_ASSIGN_OR_RETURN(std::optional<JobRow> known, rows_.FindByKey(spec.idempotency_key));
    if (known) {
      const Job& job = known->job;
      if (job.kind == spec.kind && job.subject == spec.subject && SameJson(job.payload, spec.payload)) return job;
      return Conflict("idempotency_key_reused", "this Idempotency-Key was used with another request, for " + job.id);
    }
  }
  DRUPE_ASSIGN_OR_RETURN(const std::int64_t queued, rows_.CountQueued());
  if (queued >= options_.max_queued) {
    return Status(StatusKind::kUnavailable, "queue_full",
                  std::to_string(queued) + " jobs are waiting; the limit is " + std::to_string(options_.max_queued));
  }
  JobRow row{.job = NewJob(spec, clock_.NowMs())};
  DRUPE_ASSIGN_OR_RETURN(const std::optional<std::int64_t> seq, rows_.Insert(row.job));
  // Another process has used the key since it was looked for.
  if (!seq) return FindOrInsert(spec);
  row.seq = *seq;
  DRUPE_RETURN_IF_ERROR(rows_.AddEvent(row, "submitted", row.job.created_ms));
  return row.job;
}

Result<Job> SqlJobStore::Get(std::string_view id) {
  JobRow row;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(row, life_.Find(id));
    return Status::Ok();
  }));
  return std::move(row.job);
}

Result<JobPage> SqlJobStore::List(const JobFilter& filter, int limit, const std::string& cursor) {
  if (limit < 1 || limit > kMaxPage) return InvalidArgument("invalid_limit", "limit must be 1 to 1000", "limit");
  DRUPE_ASSIGN_OR_RETURN(const std::int64_t before, ParseCursor(cursor));
  std::vector<JobRow> rows;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(rows, rows_.FindPage(filter, before, limit + 1));
    return Status::Ok();
  }));
  JobPage page;
  const auto count = std::min(rows.size(), static_cast<std::size_t>(limit));
  if (rows.size() > count) page.next_cursor = std::to_string(rows[count - 1].seq);
  for (std::size_t i = 0; i < count; ++i) page.jobs.push_back(std::move(rows[i].job));
  return page;
}

Result<std::vector<JobEvent>> SqlJobStore::History(std::string_view id) {
  std::vector<JobEvent> events;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const JobRow row, life_.Find(id));
    DRUPE_ASSIGN_OR_RETURN(events, rows_.Events(row.seq));
    return Status::Ok();
  }));
  return events;
}

Result<JobCounts> SqlJobStore::Counts() {
  JobCounts counts;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(counts, rows_.Counts());
    return Status::Ok();
  }));
  return counts;
}

Result<Job> SqlJobStore::Cancel(std::string_view id) {
  JobRow row;
  DRUPE_RETURN_IF_ERROR(Change(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(row, life_.Take(id));
    Job& job = row.job;
    if (job.state == JobState::kCancelled || job.cancel_requested) return Status::Ok();
    if (IsTerminal(job.state)) {
      return Conflict("job_finished", std::string(id) + " has already " + JobStateName(job.state));
    }
    job.cancel_requested = true;
    if (job.state == JobState::kQueued) return life_.Move(row, JobState::kCancelled, "cancelled");
    return life_.Move(row, JobState::kRunning, "cancel_requested");
  }));
  return std::move(row.job);
}

Result<Job> SqlJobStore::Retry(std::string_view id) {
  JobRow row;
  DRUPE_RETURN_IF_ERROR(Change(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(row, life_.Take(id));
    Job& job = row.job;
    if (job.state != JobState::kFailed && job.state != JobState::kCancelled) {
      return Conflict("job_not_ended", "only a failed or cancelled job can be tried again; " + std::string(id) +
                                           " is " + JobStateName(job.state));
    }
    job.cancel_requested = false;
    job.failures = 0;
    job.error.reset();
    job.stage.clear();
    job.progress = 0;
    job.available_at_ms = clock_.NowMs();
    return life_.Move(row, JobState::kQueued, "retried by request");
  }));
  return std::move(row.job);
}

// ---- what a worker says

// A claim need not survive a power cut of the worker's machine, which takes the worker away with the claim.
Result<std::optional<Job>> SqlJobStore::Claim(const std::vector<std::string>& kinds, const std::string& worker,
                                              std::int64_t lease_ms) {
  std::optional<JobRow> row;
  int expired = 0;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(expired, life_.ExpireLeases());
    const std::int64_t now = clock_.NowMs();
    DRUPE_ASSIGN_OR_RETURN(row, rows_.TakeClaimable(kinds, now));
    if (!row) return Status::Ok();
    Job& job = row->job;
    ++job.attempt;
    job.worker = worker;
    job.started_ms = now;
    job.lease_until_ms = now + lease_ms;
    job.stage.clear();
    job.progress = 0;
    const Status claimed = life_.Move(*row, JobState::kRunning, "claimed");
    return claimed.ok() ? database_.Announce() : claimed;
  }));
  if (row || expired > 0) changes_.Notify();
  return row ? std::optional<Job>(std::move(row->job)) : std::nullopt;
}

Result<bool> SqlJobStore::Beat(std::string_view id, std::int64_t attempt, const Heartbeat& heartbeat) {
  JobRow row;
  DRUPE_RETURN_IF_ERROR(Change(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(row, life_.TakeAttempt(id, attempt));
    row.job.stage = heartbeat.stage;
    row.job.progress = std::clamp(heartbeat.progress, 0.0, 1.0);
    row.job.lease_until_ms = clock_.NowMs() + heartbeat.lease_ms;
    return rows_.Update(row);
  }));
  return row.job.cancel_requested;
}

Status SqlJobStore::EndAttempt(std::string_view id, std::int64_t attempt, const std::function<Status(JobRow&)>& end) {
  return Change(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(JobRow row, life_.TakeAttempt(id, attempt));
    return end(row);
  });
}

Status SqlJobStore::Complete(std::string_view id, std::int64_t attempt, const Json& result) {
  DRUPE_RETURN_IF_ERROR(CheckSize(DumpJson(result).size(), "result"));
  return EndAttempt(id, attempt, [&](JobRow& row) {
    row.job.result = result;
    row.job.error.reset();
    row.job.progress = 1;
    return life_.Move(row, JobState::kSucceeded, "succeeded");
  });
}

Status SqlJobStore::Fail(std::string_view id, std::int64_t attempt, const JobError& error, bool retryable) {
  return EndAttempt(id, attempt, [&](JobRow& row) { return life_.Fail(row, error, retryable, Backoff::kYes); });
}

Status SqlJobStore::MarkCancelled(std::string_view id, std::int64_t attempt) {
  return EndAttempt(id, attempt, [&](JobRow& row) { return life_.Move(row, JobState::kCancelled, "cancelled"); });
}

Status SqlJobStore::Release(std::string_view id, std::int64_t attempt) {
  return EndAttempt(id, attempt, [&](JobRow& row) {
    if (row.job.cancel_requested) return life_.Move(row, JobState::kCancelled, "cancelled");
    row.job.available_at_ms = clock_.NowMs();
    return life_.Move(row, JobState::kQueued, "released");
  });
}

// ---- what time and crashes do

Result<int> SqlJobStore::ExpireLeases() {
  int expired = 0;
  DRUPE_RETURN_IF_ERROR(Change(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(expired, life_.ExpireLeases());
    return Status::Ok();
  }));
  return expired;
}

Result<int> SqlJobStore::DeleteEndedBefore(std::int64_t ended_ms, int limit, const std::vector<std::string>& kinds) {
  int deleted = 0;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(deleted, rows_.DeleteEndedBefore(ended_ms, limit, kinds));
    return Status::Ok();
  }));
  return deleted;
}

Status SqlJobStore::Recover() {
  int recovered = 0;
  DRUPE_RETURN_IF_ERROR(Change(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(recovered, life_.RecoverRunning());
    return Status::Ok();
  }));
  if (recovered > 0) Log(LogLevel::kInfo, "recovered interrupted jobs", {{"count", recovered}});
  return Status::Ok();
}

}  // namespace

Result<std::unique_ptr<JobStore>> OpenJobStore(Database& database, const JobStoreOptions& options) {
  return OpenJobStore(database, options, database.clock());
}

Result<std::unique_ptr<JobStore>> OpenJobStore(Database& database, const JobStoreOptions& options, const Clock& clock) {
  auto store = std::make_unique<SqlJobStore>(database, options, clock);
  DRUPE_RETURN_IF_ERROR(store->Open());
  return std::unique_ptr<JobStore>(std::move(store));
}

}  // namespace drupe
