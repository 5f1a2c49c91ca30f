#include "jobs/sql/job_rows.h"

#include <limits>

namespace drupe {

namespace {

// States are stored as the numbers of JobState: 0 queued, 1 running, 2 succeeded, 3 failed, 4 cancelled.
const Migrations& Schema() {
  static const Migrations kSchema = {R"sql(
    CREATE TABLE jobs (
      seq INTEGER PRIMARY KEY AUTOINCREMENT,
      id TEXT NOT NULL UNIQUE,
      kind TEXT NOT NULL,
      subject TEXT NOT NULL,
      payload TEXT NOT NULL,
      priority INTEGER NOT NULL,
      idempotency_key TEXT UNIQUE,
      state INTEGER NOT NULL,
      cancel_requested INTEGER NOT NULL,
      stage TEXT NOT NULL,
      progress REAL NOT NULL,
      attempt INTEGER NOT NULL,
      failures INTEGER NOT NULL,
      max_attempts INTEGER NOT NULL,
      worker TEXT NOT NULL,
      lease_until_ms INTEGER NOT NULL,
      available_at_ms INTEGER NOT NULL,
      created_ms INTEGER NOT NULL,
      started_ms INTEGER NOT NULL,
      finished_ms INTEGER NOT NULL,
      result TEXT,
      error_code TEXT,
      error_message TEXT,
      error_field TEXT
    );
    CREATE INDEX jobs_to_claim ON jobs (priority DESC, seq, kind, available_at_ms) WHERE state = 0;
    CREATE INDEX jobs_by_lease ON jobs (lease_until_ms) WHERE state = 1;
    CREATE INDEX jobs_by_subject ON jobs (subject, seq);
    CREATE INDEX jobs_by_state ON jobs (state, created_ms);
    CREATE TABLE job_events (
      job INTEGER NOT NULL REFERENCES jobs (seq) ON DELETE CASCADE,
      number INTEGER NOT NULL,
      at_ms INTEGER NOT NULL,
      state INTEGER NOT NULL,
      attempt INTEGER NOT NULL,
      worker TEXT NOT NULL,
      reason TEXT NOT NULL,
      PRIMARY KEY (job, number)
    ) WITHOUT ROWID;
  )sql",
                                     "ALTER TABLE jobs ADD COLUMN trace TEXT NOT NULL DEFAULT ''"};
  return kSchema;
}

constexpr std::string_view kSelect =
    "SELECT seq, id, kind, subject, payload, priority, idempotency_key, state, cancel_requested, stage, progress, "
    "attempt, failures, max_attempts, worker, lease_until_ms, available_at_ms, created_ms, started_ms, finished_ms, "
    "result, error_code, error_message, error_field, trace FROM jobs ";

constexpr JsonLimits kStoredJson{.max_bytes = std::numeric_limits<std::size_t>::max(), .max_depth = 256};

std::string Select(std::string_view rest) {
  return std::string(kSelect).append(rest);
}

/// The present row of a query that starts with kSelect.
Result<JobRow> ReadRow(const Statement& row) {
  int column = 0;
  const auto text = [&] { return row.Text(column++); };
  const auto number = [&] { return row.Int(column++); };
  // What the database holds was checked when it came in; a payload may nest what a user sent a little deeper.
  const auto json = [&] { return ParseJson(text(), kStoredJson); };
  JobRow read;
  Job& job = read.job;
  read.seq = number();
  job.id = text();
  job.kind = text();
  job.subject = text();
  DRUPE_ASSIGN_OR_RETURN(job.payload, json());
  job.priority = static_cast<int>(number());
  job.idempotency_key = text();
  job.state = static_cast<JobState>(number());
  job.cancel_requested = number() != 0;
  job.stage = text();
  job.progress = row.Real(column++);
  job.attempt = number();
  job.failures = static_cast<int>(number());
  job.max_attempts = static_cast<int>(number());
  job.worker = text();
  job.lease_until_ms = number();
  job.available_at_ms = number();
  job.created_ms = number();
  job.started_ms = number();
  job.finished_ms = number();
  if (row.IsNull(column)) {
    ++column;
  } else {
    DRUPE_ASSIGN_OR_RETURN(job.result, json());
  }
  if (!row.IsNull(column)) job.error = JobError{row.Text(column), row.Text(column + 1), row.Text(column + 2)};
  job.trace = row.Text(column + 3);
  return read;
}

void BindError(Statement& statement, const std::optional<JobError>& error) {
  if (error) {
    statement.Bind(error->code).Bind(error->message).Bind(error->field);
  } else {
    statement.BindNull().BindNull().BindNull();
  }
}

/// "?, ?, ?"
std::string Placeholders(std::size_t count) {
  std::string list = "?";
  for (std::size_t i = 1; i < count; ++i) list += ", ?";
  return list;
}

}  // namespace

Status JobRows::Migrate() {
  return database_.Migrate("jobs", Schema());
}

Result<std::optional<std::int64_t>> JobRows::Insert(const Job& job) {
  DRUPE_ASSIGN_OR_RETURN(
      const auto insert,
      database_.Prepare("INSERT INTO jobs (id, kind, subject, payload, priority, idempotency_key, state, "
                        "cancel_requested, stage, progress, attempt, failures, max_attempts, worker, lease_until_ms, "
                        "available_at_ms, created_ms, started_ms, finished_ms, trace) "
                        "VALUES (?, ?, ?, ?, ?, ?, 0, 0, '', 0, 0, 0, ?, '', 0, ?, ?, 0, 0, ?) "
                        "ON CONFLICT (idempotency_key) DO NOTHING RETURNING seq"));
  insert->Bind(job.id).Bind(job.kind).Bind(job.subject).Bind(DumpJson(job.payload)).Bind(job.priority);
  job.idempotency_key.empty() ? insert->BindNull() : insert->Bind(job.idempotency_key);
  insert->Bind(job.max_attempts).Bind(job.available_at_ms).Bind(job.created_ms).Bind(job.trace);
  DRUPE_ASSIGN_OR_RETURN(const bool inserted, insert->Step());
  if (!inserted) return std::optional<std::int64_t>();
  const std::int64_t seq = insert->Int(0);
  DRUPE_RETURN_IF_ERROR(insert->Run());  // SQLite inserts for good when the statement is done
  return std::optional(seq);
}

Status JobRows::Update(const JobRow& row) {
  DRUPE_ASSIGN_OR_RETURN(
      const auto update,
      database_.Prepare("UPDATE jobs SET state = ?, cancel_requested = ?, stage = ?, progress = ?, attempt = ?, "
                        "failures = ?, worker = ?, lease_until_ms = ?, available_at_ms = ?, started_ms = ?, "
                        "finished_ms = ?, result = ?, error_code = ?, error_message = ?, error_field = ? "
                        "WHERE seq = ?"));
  const Job& job = row.job;
  update->Bind(static_cast<int>(job.state)).Bind(job.cancel_requested ? 1 : 0).Bind(job.stage).Bind(job.progress);
  update->Bind(job.attempt).Bind(job.failures).Bind(job.worker).Bind(job.lease_until_ms).Bind(job.available_at_ms);
  update->Bind(job.started_ms).Bind(job.finished_ms);
  job.result ? update->Bind(DumpJson(*job.result)) : update->BindNull();
  BindError(*update, job.error);
  return update->Bind(row.seq).Run();
}

Status JobRows::AddEvent(const JobRow& row, std::string_view reason, std::int64_t at_ms) {
  DRUPE_ASSIGN_OR_RETURN(
      const auto insert,
      database_.Prepare("INSERT INTO job_events (job, number, at_ms, state, attempt, worker, reason) VALUES "
                        "(?, (SELECT COALESCE(MAX(number), 0) + 1 FROM job_events WHERE job = ?), ?, ?, ?, ?, ?)"));
  insert->Bind(row.seq).Bind(row.seq).Bind(at_ms).Bind(static_cast<int>(row.job.state)).Bind(row.job.attempt);
  return insert->Bind(row.job.worker).Bind(reason).Run();
}

Result<std::optional<JobRow>> JobRows::FindOne(Statement& query) {
  DRUPE_ASSIGN_OR_RETURN(const bool found, query.Step());
  if (!found) return std::optional<JobRow>();
  DRUPE_ASSIGN_OR_RETURN(JobRow row, ReadRow(query));
  return std::optional<JobRow>(std::move(row));
}

Result<std::vector<JobRow>> JobRows::FindAll(Statement& query) {
  std::vector<JobRow> rows;
  for (;;) {
    DRUPE_ASSIGN_OR_RETURN(std::optional<JobRow> row, FindOne(query));
    if (!row) return rows;
    rows.push_back(std::move(*row));
  }
}

Result<std::optional<JobRow>> JobRows::FindById(std::string_view id) {
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare(Select("WHERE id = ?")));
  return FindOne(query->Bind(id));
}

Result<std::optional<JobRow>> JobRows::TakeById(std::string_view id) {
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare(Select("WHERE id = ?").append(database_.WaitForRows())));
  return FindOne(query->Bind(id));
}

Result<std::optional<JobRow>> JobRows::FindByKey(std::string_view idempotency_key) {
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare(Select("WHERE idempotency_key = ?")));
  return FindOne(query->Bind(idempotency_key));
}

Result<std::optional<JobRow>> JobRows::TakeClaimable(const std::vector<std::string>& kinds, std::int64_t now_ms) {
  if (kinds.empty()) return std::optional<JobRow>();
  const std::string condition =
      "WHERE state = 0 AND available_at_ms <= ? AND kind IN (" + Placeholders(kinds.size()) + ") ORDER BY priority DESC, seq LIMIT 1";
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare(Select(condition).append(database_.SkipTakenRows())));
  query->Bind(now_ms);
  for (const std::string& kind : kinds) query->Bind(kind);
  return FindOne(*query);
}

Result<std::vector<JobRow>> JobRows::TakeExpired(std::int64_t now_ms) {
  const std::string condition = "WHERE state = 1 AND lease_until_ms < ? ORDER BY seq";
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare(Select(condition).append(database_.SkipTakenRows())));
  return FindAll(query->Bind(now_ms));
}

Result<std::vector<JobRow>> JobRows::FindPage(const JobFilter& filter, std::int64_t before, int limit) {
  std::string sql = Select("WHERE seq < ?");
  if (!filter.kind.empty()) sql += " AND kind = ?";
  if (!filter.subject.empty()) sql += " AND subject = ?";
  if (filter.state) sql += " AND state = ?";
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare(sql + " ORDER BY seq DESC LIMIT ?"));
  query->Bind(before);
  if (!filter.kind.empty()) query->Bind(filter.kind);
  if (!filter.subject.empty()) query->Bind(filter.subject);
  if (filter.state) query->Bind(static_cast<int>(*filter.state));
  return FindAll(query->Bind(limit));
}

Result<std::vector<JobEvent>> JobRows::Events(std::int64_t seq) {
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare("SELECT at_ms, state, attempt, worker, reason FROM "
                                                             "job_events WHERE job = ? ORDER BY number"));
  query->Bind(seq);
  std::vector<JobEvent> events;
  for (;;) {
    DRUPE_ASSIGN_OR_RETURN(const bool found, query->Step());
    if (!found) return events;
    events.push_back(
        {query->Int(0), static_cast<JobState>(query->Int(1)), query->Int(2), query->Text(3), query->Text(4)});
  }
}

Result<JobCounts> JobRows::Counts() {
  DRUPE_ASSIGN_OR_RETURN(const auto query,
                         database_.Prepare("SELECT state, COUNT(*), MIN(created_ms) FROM jobs GROUP BY state"));
  JobCounts counts;
  std::int64_t* const by_state[] = {&counts.queued, &counts.running, &counts.succeeded, &counts.failed,
                                    &counts.cancelled};
  for (;;) {
    DRUPE_ASSIGN_OR_RETURN(const bool found, query->Step());
    if (!found) return counts;
    *by_state[query->Int(0)] = query->Int(1);
    if (query->Int(0) == static_cast<int>(JobState::kQueued)) counts.oldest_queued_ms = query->Int(2);
  }
}

Result<int> JobRows::DeleteEndedBefore(std::int64_t ended_ms, int limit, const std::vector<std::string>& kinds) {
  const std::string of_kind = kinds.empty() ? "" : " AND kind IN (" + Placeholders(kinds.size()) + ")";
  DRUPE_ASSIGN_OR_RETURN(
      const auto remove,
      database_.Prepare("DELETE FROM jobs WHERE seq IN (SELECT seq FROM jobs WHERE state >= 2 AND finished_ms < ?" +
                        of_kind + " ORDER BY seq LIMIT ?) RETURNING seq"));
  remove->Bind(ended_ms);
  for (const std::string& kind : kinds) remove->Bind(kind);
  remove->Bind(limit);
  for (int removed = 0;; ++removed) {
    DRUPE_ASSIGN_OR_RETURN(const bool one_more, remove->Step());
    if (!one_more) return removed;
  }
}

Result<std::int64_t> JobRows::CountQueued() {
  DRUPE_ASSIGN_OR_RETURN(const auto query, database_.Prepare("SELECT COUNT(*) FROM jobs WHERE state = 0"));
  DRUPE_RETURN_IF_ERROR(query->Step().status());
  return query->Int(0);
}

}  // namespace drupe
