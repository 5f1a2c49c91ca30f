#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/status.h"

struct sqlite3;
struct sqlite3_stmt;

namespace drupe {

/// A prepared statement in use: bind in order, step, read columns in order. Reset when it goes out of scope. An error
/// is kept and comes out of Step, so that binds need no checks.
class SqliteStatement {
 public:
  SqliteStatement(sqlite3* connection, sqlite3_stmt* statement);
  ~SqliteStatement();
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  SqliteStatement& Bind(std::string_view text);
  SqliteStatement& Bind(std::int64_t number);
  SqliteStatement& Bind(int number) { return Bind(static_cast<std::int64_t>(number)); }
  SqliteStatement& Bind(double number);
  SqliteStatement& BindNull();

  /// True: a row is there. False: the statement is done. Errors as SqliteDatabase's.
  Result<bool> Step();
  /// Steps a statement that returns no rows.
  Status Run();

  /// Columns of the present row, counted from 0. A NULL reads as "", 0.
  std::string Text(int column) const;
  std::int64_t Int(int column) const;
  double Real(int column) const;
  bool IsNull(int column) const;

 private:
  sqlite3* connection_;
  sqlite3_stmt* statement_;
  int next_parameter_ = 1;
  int bind_error_ = 0;
};

/// One step of a schema: SQL that takes it from version n to n + 1 (n = the place in the list).
using SqliteMigrations = std::vector<std::string>;

/// What a transaction must survive once it has returned.
enum class SqliteDurability {
  kPowerCut,     ///< fsynced
  kProcessDeath  ///< in the page cache; a later kPowerCut transaction makes it durable too
};

/// One SQLite file owned by one process, through one connection behind a mutex: SQLite up to 3.51.2 can lose the WAL
/// when several connections reset it, and several processes on a network file system corrupt it. WAL, synchronous=FULL.
/// Errors: 503 `database_in_use` (another process owns the file), 507 `disk_full`, 500 `database_failed`,
/// 500 `database_newer` (written by a later version of this software). Thread-safe.
class SqliteDatabase {
 public:
  /// Opens or creates the file and takes its ownership, which the kernel releases when the process ends.
  static Result<std::unique_ptr<SqliteDatabase>> Open(const std::filesystem::path& file);
  ~SqliteDatabase();

  /// Brings the tables of `component` to the newest version. Steps already taken are never changed, only added to.
  Status Migrate(std::string_view component, const SqliteMigrations& migrations);

  /// Runs `body` in one transaction, with the connection to itself; commits when it returns OK, else rolls back.
  Status Transaction(SqliteDurability durability, const std::function<Status()>& body);

  /// The statement for `sql`, compiled on first use and kept. Only inside Transaction.
  Result<std::unique_ptr<SqliteStatement>> Prepare(std::string_view sql);
  /// Runs a statement without parameters or rows. Only inside Transaction.
  Status Execute(std::string_view sql);
  /// Rows changed by the last statement.
  int Changes() const;
  std::int64_t LastRowId() const;

 private:
  SqliteDatabase() = default;
  Status Configure();
  Status SetDurability(SqliteDurability durability);

  std::mutex mutex_;
  int lock_fd_ = -1;
  sqlite3* connection_ = nullptr;
  std::unordered_map<std::string, sqlite3_stmt*> statements_;
  SqliteDurability durability_ = SqliteDurability::kPowerCut;
  Status broken_;  ///< set once an fsync has failed
};

}  // namespace drupe
