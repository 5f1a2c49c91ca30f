#include "defect_analysis/report_index.h"

#include <algorithm>
#include <utility>

#include "jobs/sql/page_cursor.h"

namespace drupe {

namespace {

// grades: one digit a fruit, the number of its DefectClass, so that "%3%" finds reports with a crack.
// artifacts: JSON with their digests, which is how the collection of garbage knows them.
const Migrations& Schema() {
  static const Migrations kSchema = {R"sql(
    CREATE TABLE analyses (
      reconstruction TEXT PRIMARY KEY,
      job TEXT NOT NULL
    ) WITHOUT ROWID;
    CREATE INDEX analyses_by_job ON analyses (job);
    CREATE TABLE reports (
      seq INTEGER PRIMARY KEY AUTOINCREMENT,
      job TEXT NOT NULL UNIQUE,
      reconstruction TEXT NOT NULL,
      created_ms INTEGER NOT NULL,
      grades TEXT NOT NULL,
      defects INTEGER NOT NULL,
      json_sha256 TEXT NOT NULL,
      csv_sha256 TEXT NOT NULL
    );
  )sql",
                                     "ALTER TABLE reports ADD COLUMN artifacts TEXT NOT NULL DEFAULT '[]'"};
  return kSchema;
}

char GradeDigit(DefectClass grade) {
  return static_cast<char>('0' + static_cast<int>(grade));
}

std::string GradeDigits(const std::vector<DefectClass>& grades) {
  std::string digits;
  for (const DefectClass grade : grades) digits.push_back(GradeDigit(grade));
  return digits;
}

constexpr std::string_view kSelect =
    "SELECT job, reconstruction, created_ms, grades, defects, json_sha256, csv_sha256, artifacts, seq FROM "
    "reports ";
constexpr int kSeqColumn = 8;

Result<ReportEntry> ReadEntry(const Statement& row) {
  ReportEntry entry{.job = row.Text(0), .reconstruction = row.Text(1), .created_ms = row.Int(2)};
  for (const char digit : row.Text(3)) entry.grades.push_back(static_cast<DefectClass>(digit - '0'));
  entry.defects = static_cast<int>(row.Int(4));
  entry.json_sha256 = row.Text(5);
  entry.csv_sha256 = row.Text(6);
  DRUPE_ASSIGN_OR_RETURN(const Json artifacts, ParseJson(row.Text(7)));
  entry.artifacts = ParseArtifacts(artifacts);
  return entry;
}

}  // namespace

Result<ReportIndex> ReportIndex::Open(Database& database) {
  DRUPE_RETURN_IF_ERROR(database.Migrate("reports", Schema()));
  return ReportIndex(database);
}

Status ReportIndex::SetCurrentJob(std::string_view reconstruction, std::string_view job) {
  return database_->Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto insert,
                           database_->Prepare("INSERT INTO analyses (reconstruction, job) VALUES (?, ?) "
                                              "ON CONFLICT (reconstruction) DO UPDATE SET job = excluded.job"));
    return insert->Bind(reconstruction).Bind(job).Run();
  });
}

Result<std::optional<std::string>> ReportIndex::CurrentJob(std::string_view reconstruction) {
  std::optional<std::string> job;
  DRUPE_RETURN_IF_ERROR(database_->Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto query, database_->Prepare("SELECT job FROM analyses WHERE reconstruction = ?"));
    DRUPE_ASSIGN_OR_RETURN(const bool found, query->Bind(reconstruction).Step());
    if (found) job = query->Text(0);
    return Status::Ok();
  }));
  return job;
}

Status ReportIndex::Add(const ReportEntry& entry) {
  return database_->Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(
        const auto insert,
        database_->Prepare("INSERT INTO reports (job, reconstruction, created_ms, grades, defects, json_sha256, "
                           "csv_sha256, artifacts) VALUES (?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (job) DO NOTHING"));
    insert->Bind(entry.job).Bind(entry.reconstruction).Bind(entry.created_ms).Bind(GradeDigits(entry.grades));
    insert->Bind(entry.defects).Bind(entry.json_sha256).Bind(entry.csv_sha256);
    return insert->Bind(DumpJson(ToJson(entry.artifacts))).Run();
  });
}

Status ReportIndex::ForgetGone(std::int64_t before_ms) {
  return database_->Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto reports,
                           database_->Prepare("DELETE FROM reports WHERE created_ms < ? AND NOT EXISTS (SELECT 1 FROM "
                                              "jobs WHERE jobs.id = reports.job)"));
    DRUPE_RETURN_IF_ERROR(reports->Bind(before_ms).Run());
    DRUPE_ASSIGN_OR_RETURN(const auto analyses,
                           database_->Prepare("DELETE FROM analyses WHERE NOT EXISTS (SELECT 1 FROM jobs WHERE "
                                              "jobs.id = analyses.job)"));
    return analyses->Run();
  });
}

Result<std::optional<ReportEntry>> ReportIndex::FindByJob(std::string_view job) {
  std::optional<ReportEntry> entry;
  DRUPE_RETURN_IF_ERROR(database_->Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto query, database_->Prepare(std::string(kSelect) + "WHERE job = ?"));
    DRUPE_ASSIGN_OR_RETURN(const bool found, query->Bind(job).Step());
    if (!found) return Status::Ok();
    DRUPE_ASSIGN_OR_RETURN(entry, ReadEntry(*query));
    return Status::Ok();
  }));
  return entry;
}

Result<ReportPage> ReportIndex::List(const ReportQuery& query) {
  DRUPE_ASSIGN_OR_RETURN(const std::int64_t before, ParseCursor(query.cursor));
  const std::string pattern = query.grade ? std::string{'%', GradeDigit(*query.grade), '%'} : "%";
  ReportPage page;
  DRUPE_RETURN_IF_ERROR(database_->Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(
        const auto select,
        database_->Prepare(std::string(kSelect) + "WHERE seq < ? AND created_ms >= ? AND grades LIKE ? AND EXISTS "
                                                  "(SELECT 1 FROM analyses WHERE analyses.job = reports.job) "
                                                  "ORDER BY seq DESC LIMIT ?"));
    select->Bind(before).Bind(query.since_ms).Bind(pattern).Bind(query.limit + 1);
    for (std::int64_t last_seq = 0;;) {
      DRUPE_ASSIGN_OR_RETURN(const bool found, select->Step());
      if (!found) return Status::Ok();
      if (static_cast<int>(page.reports.size()) == query.limit) {
        page.next_cursor = std::to_string(last_seq);
        return Status::Ok();
      }
      DRUPE_ASSIGN_OR_RETURN(ReportEntry entry, ReadEntry(*select));
      page.reports.push_back(std::move(entry));
      last_seq = select->Int(kSeqColumn);
    }
  }));
  return page;
}

}  // namespace drupe
