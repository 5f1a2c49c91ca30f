#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "jobs/job.h"
#include "jobs/sql/database.h"

namespace drupe {

/// A job and its place in the order of submission.
struct JobRow {
  std::int64_t seq = 0;
  Job job = {};
};

/// The tables `jobs` and `job_events`, one statement a function. All calls are made inside a transaction.
class JobRows {
 public:
  explicit JobRows(Database& database) : database_(database) {}

  Status Migrate();
  /// Inserts `job` and returns its seq; nothing when its idempotency key is taken.
  Result<std::optional<std::int64_t>> Insert(const Job& job);
  /// Writes everything that changes in a job's life: state, progress, attempt, lease, outcome.
  Status Update(const JobRow& row);
  Status AddEvent(const JobRow& row, std::string_view reason, std::int64_t at_ms);

  Result<std::optional<JobRow>> FindById(std::string_view id);
  /// As FindById, and keeps others from changing the row until the transaction ends; so do all that are called Take.
  Result<std::optional<JobRow>> TakeById(std::string_view id);
  Result<std::optional<JobRow>> FindByKey(std::string_view idempotency_key);
  /// The queued job that is to be claimed next at `now_ms`.
  Result<std::optional<JobRow>> TakeClaimable(const std::vector<std::string>& kinds, std::int64_t now_ms);
  /// Running jobs whose lease ended before `now_ms`.
  Result<std::vector<JobRow>> TakeExpired(std::int64_t now_ms);
  /// Jobs with seq < `before`, newest first.
  Result<std::vector<JobRow>> FindPage(const JobFilter& filter, std::int64_t before, int limit);
  Result<std::vector<JobEvent>> Events(std::int64_t seq);
  Result<JobCounts> Counts();
  Result<std::int64_t> CountQueued();
  /// Deletes up to `limit` jobs of `kinds` (empty: of all) that ended before `ended_ms`, with their events; returns how
  /// many.
  Result<int> DeleteEndedBefore(std::int64_t ended_ms, int limit, const std::vector<std::string>& kinds);

 private:
  Result<std::optional<JobRow>> FindOne(Statement& query);
  Result<std::vector<JobRow>> FindAll(Statement& query);

  Database& database_;
};

}  // namespace drupe
