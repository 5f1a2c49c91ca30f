#include "service/open_database.h"

#include <string_view>

#include "jobs/postgres/postgres_database.h"
#include "jobs/sqlite/database.h"

namespace drupe {

namespace {

constexpr std::string_view kSqlite = "sqlite:";

Result<std::unique_ptr<Database>> OpenSqlite(const std::filesystem::path& file) {
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<SqliteDatabase> database, SqliteDatabase::Open(file));
  return std::unique_ptr<Database>(std::move(database));
}

}  // namespace

Result<std::unique_ptr<Database>> OpenDatabase(const std::string& url, const std::filesystem::path& data,
                                               const std::string& service) {
  if (url.empty()) return OpenSqlite(data / (service + ".db"));
  if (url.starts_with(kSqlite) && url.size() > kSqlite.size()) return OpenSqlite(url.substr(kSqlite.size()));
  if (url.starts_with("postgres://") || url.starts_with("postgresql://")) {
    return OpenPostgresDatabase(url, "drupe_" + service);
  }
  // Not repeated in the message: it may hold a password.
  return InvalidArgument("invalid_jobs_url", "the job database is sqlite:PATH or postgres://USER@HOST/DATABASE",
                         "jobs_url");
}

}  // namespace drupe
