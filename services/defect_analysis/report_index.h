#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "jobs/sql/database.h"
#include "scene/report.h"
#include "service/artifacts.h"

namespace drupe {

/// What is known of a finished report without reading it.
struct ReportEntry {
  std::string job = "";             ///< that made it
  std::string reconstruction = "";  ///< that it is about
  std::int64_t created_ms = 0;
  std::vector<DefectClass> grades = {};  ///< one a fruit
  int defects = 0;                       ///< of all fruits
  std::string json_sha256 = "";          ///< the object that holds the report as JSON
  std::string csv_sha256 = "";           ///< and as CSV
  std::vector<Artifact> artifacts = {};  ///< these two and all other files; none in reports of older versions

  bool operator==(const ReportEntry&) const = default;
};

struct ReportQuery {
  std::optional<DefectClass> grade = std::nullopt;  ///< reports with a fruit of this grade
  std::int64_t since_ms = 0;                        ///< created then or later
  int limit = 100;                                  ///< 1..1000
  std::string cursor = "";                          ///< next_cursor of the page before; empty for the first
};

struct ReportPage {
  std::vector<ReportEntry> reports;  ///< newest first
  std::string next_cursor;           ///< empty: this was the last page
};

/// Which analysis of a reconstruction is the current one, and what the finished reports hold. The tables lie in the
/// service's database beside its jobs. Thread-safe.
class ReportIndex {
 public:
  /// `database` must outlive the index.
  static Result<ReportIndex> Open(Database& database);

  /// Makes `job` the analysis that readers of the reconstruction's report see.
  Status SetCurrentJob(std::string_view reconstruction, std::string_view job);
  /// Nothing when no analysis was ever asked for.
  Result<std::optional<std::string>> CurrentJob(std::string_view reconstruction);

  /// Adds the report of a job; a job that has one keeps it.
  Status Add(const ReportEntry& entry);
  /// Forgets the reports made before `before_ms` whose jobs are forgotten.
  Status ForgetGone(std::int64_t before_ms);
  Result<std::optional<ReportEntry>> FindByJob(std::string_view job);
  /// Reports of current analyses. Errors: 400 `invalid_cursor`.
  Result<ReportPage> List(const ReportQuery& query);

 private:
  explicit ReportIndex(Database& database) : database_(&database) {}

  Database* database_;
};

}  // namespace drupe
