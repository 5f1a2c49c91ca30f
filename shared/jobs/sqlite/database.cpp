#include "jobs/sqlite/database.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "base/files.h"
#include "jobs/sqlite/errors.h"

namespace drupe {

Status StatusFromSqlite(sqlite3* connection, std::string_view doing) {
  const int code = sqlite3_extended_errcode(connection);
  const std::string message =
      std::string(doing) + ": " + sqlite3_errmsg(connection) + " (SQLite " + std::to_string(code) + ")";
  if ((code & 0xff) == SQLITE_FULL) return {StatusKind::kInsufficientStorage, "disk_full", message};
  return Internal("database_failed", message);
}

namespace {

/// Takes the exclusive lock that makes this process the owner of the database; it goes with the descriptor.
Result<int> LockOwnership(const std::filesystem::path& database_file) {
  const std::string lock_file = database_file.string() + ".lock";
  const int fd = ::open(lock_file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) return StatusFromErrno(errno, "open", lock_file);
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  const int error = errno;
  ::close(fd);
  if (error != EWOULDBLOCK) return StatusFromErrno(error, "lock", lock_file);
  return Status(StatusKind::kUnavailable, "database_in_use",
                database_file.string() +
                    " belongs to another running process; stop it, choose another --data, or share the "
                    "jobs through PostgreSQL (--jobs-url)");
}

}  // namespace

Result<std::unique_ptr<SqliteDatabase>> SqliteDatabase::Open(const std::filesystem::path& file) {
  std::unique_ptr<SqliteDatabase> database(new SqliteDatabase());
  DRUPE_ASSIGN_OR_RETURN(database->lock_fd_, LockOwnership(file));
  // The mutex here is the only guard that is needed, hence NOMUTEX.
  constexpr int kFlags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
  if (sqlite3_open_v2(file.c_str(), &database->connection_, kFlags, nullptr) != SQLITE_OK) {
    return StatusFromSqlite(database->connection_, "open " + file.string());
  }
  DRUPE_RETURN_IF_ERROR(database->Configure());
  return database;
}

SqliteDatabase::~SqliteDatabase() {
  for (const auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close(connection_);
  // Last, so that no other process opens the file before this connection has closed it.
  if (lock_fd_ >= 0) ::close(lock_fd_);
}

Status SqliteDatabase::Configure() {
  sqlite3_extended_result_codes(connection_, 1);
  sqlite3_busy_timeout(connection_, 5'000);  // for a person looking with the sqlite3 shell
  for (const char* pragma : {"PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL", "PRAGMA foreign_keys=ON",
                             "PRAGMA temp_store=MEMORY", "PRAGMA trusted_schema=OFF"}) {
    DRUPE_RETURN_IF_ERROR(Execute(pragma));
  }
  return Status::Ok();
}

Status SqliteDatabase::Transaction(Durability durability, const std::function<Status()>& body) {
  const std::lock_guard lock(mutex_);
  DRUPE_RETURN_IF_ERROR(broken_);
  DRUPE_RETURN_IF_ERROR(SetDurability(durability));
  DRUPE_RETURN_IF_ERROR(Execute("BEGIN IMMEDIATE"));
  Status outcome = body();
  if (outcome.ok()) outcome = Execute("COMMIT");
  if (!outcome.ok()) {
    // After a failed fsync the kernel may have dropped pages that SQLite believes written: only a restart, which reads
    // the file anew, is safe.
    if (sqlite3_extended_errcode(connection_) == SQLITE_IOERR_FSYNC) broken_ = outcome;
    // Some errors (a full disk) have rolled back already.
    if (sqlite3_get_autocommit(connection_) == 0) (void)Execute("ROLLBACK");
  }
  return outcome;
}

Status SqliteDatabase::SetDurability(Durability durability) {
  if (durability == durability_) return Status::Ok();
  const bool sync = durability == Durability::kPowerCut;
  DRUPE_RETURN_IF_ERROR(Execute(sync ? "PRAGMA synchronous=FULL" : "PRAGMA synchronous=NORMAL"));
  durability_ = durability;
  return Status::Ok();
}

Result<std::unique_ptr<Statement>> SqliteDatabase::Prepare(std::string_view sql) {
  sqlite3_stmt*& statement = statements_[std::string(sql)];
  if (statement == nullptr) {
    constexpr unsigned kFlags = SQLITE_PREPARE_PERSISTENT;
    if (sqlite3_prepare_v3(connection_, sql.data(), static_cast<int>(sql.size()), kFlags, &statement, nullptr) !=
        SQLITE_OK) {
      return StatusFromSqlite(connection_, sql);
    }
  }
  return std::unique_ptr<Statement>(std::make_unique<SqliteStatement>(connection_, statement));
}

Status SqliteDatabase::Execute(std::string_view sql) {
  if (sqlite3_exec(connection_, std::string(sql).c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) return Status::Ok();
  return StatusFromSqlite(connection_, sql);
}

}  // namespace drupe
