#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>

#include "base/status.h"
#include "jobs/sql/database.h"

struct sqlite3;
struct sqlite3_stmt;

namespace drupe {

/// Reset when it goes out of scope.
class SqliteStatement : public Statement {
 public:
  SqliteStatement(sqlite3* connection, sqlite3_stmt* statement);
  ~SqliteStatement() override;
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(const SqliteStatement&) = delete;

  using Statement::Bind;
  Statement& Bind(std::string_view text) override;
  Statement& Bind(std::int64_t number) override;
  Statement& Bind(double number) override;
  Statement& BindNull() override;
  Result<bool> Step() override;
  std::string Text(int column) const override;
  std::int64_t Int(int column) const override;
  double Real(int column) const override;
  bool IsNull(int column) const override;

 private:
  sqlite3* connection_;
  sqlite3_stmt* statement_;
  int next_parameter_ = 1;
  int bind_error_ = 0;
};

/// One SQLite file owned by one process, through one connection behind a mutex: SQLite up to 3.51.2 can lose the WAL
/// when several connections reset it, and several processes on a network file system corrupt it. WAL, synchronous=FULL.
/// Of the errors of Database, `database_in_use` means that another process owns the file.
class SqliteDatabase : public Database {
 public:
  /// Opens or creates the file and takes its ownership, which the kernel releases when the process ends.
  static Result<std::unique_ptr<SqliteDatabase>> Open(const std::filesystem::path& file);
  ~SqliteDatabase() override;

  Status Transaction(Durability durability, const std::function<Status()>& body) override;
  Result<std::unique_ptr<Statement>> Prepare(std::string_view sql) override;
  Status Execute(std::string_view sql) override;
  bool IsShared() const override { return false; }
  const Clock& clock() const override { return Clock::System(); }

 protected:
  std::string_view TextColumnsQuery() const override {
    return "SELECT m.name, c.name FROM sqlite_master m, pragma_table_info(m.name) c"
           " WHERE m.type = 'table' AND c.type = 'TEXT'";
  }

 private:
  SqliteDatabase() = default;
  Status Configure();
  Status SetDurability(Durability durability);

  std::mutex mutex_;
  int lock_fd_ = -1;
  sqlite3* connection_ = nullptr;
  std::unordered_map<std::string, sqlite3_stmt*> statements_;
  Durability durability_ = Durability::kPowerCut;
  Status broken_;  ///< set once an fsync has failed
};

}  // namespace drupe
