#include "jobs/sql/database.h"

namespace drupe {

Status Statement::Run() {
  DRUPE_ASSIGN_OR_RETURN(const bool row, Step());
  return row ? Internal("database_failed", "a statement returned rows that nobody reads") : Status::Ok();
}

Result<std::vector<TextColumn>> Database::TextColumns() {
  DRUPE_ASSIGN_OR_RETURN(const auto rows, Prepare(TextColumnsQuery()));
  std::vector<TextColumn> columns;
  for (;;) {
    DRUPE_ASSIGN_OR_RETURN(const bool more, rows->Step());
    if (!more) return columns;
    columns.push_back({rows->Text(0), rows->Text(1)});
  }
}

Status Database::Migrate(std::string_view component, const Migrations& migrations) {
  return Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_RETURN_IF_ERROR(LockForMigration());
    DRUPE_RETURN_IF_ERROR(
        Execute("CREATE TABLE IF NOT EXISTS schema_versions (component TEXT PRIMARY KEY, version INTEGER NOT NULL)"));
    std::int64_t version = 0;
    {
      DRUPE_ASSIGN_OR_RETURN(const auto query, Prepare("SELECT version FROM schema_versions WHERE component = ?"));
      DRUPE_ASSIGN_OR_RETURN(const bool known, query->Bind(component).Step());
      if (known) version = query->Int(0);
    }
    const auto newest = static_cast<std::int64_t>(migrations.size());
    if (version > newest) {
      return Internal("database_newer", "the tables of " + std::string(component) + " have version " +
                                            std::to_string(version) + "; this program knows " + std::to_string(newest));
    }
    for (; version < newest; ++version) {
      DRUPE_RETURN_IF_ERROR(Execute(migrations[static_cast<std::size_t>(version)]));
    }
    DRUPE_ASSIGN_OR_RETURN(const auto update, Prepare("INSERT INTO schema_versions (component, version) VALUES (?, ?)"
                                                      " ON CONFLICT (component) DO UPDATE SET version = "
                                                      "excluded.version"));
    return update->Bind(component).Bind(newest).Run();
  });
}

}  // namespace drupe
