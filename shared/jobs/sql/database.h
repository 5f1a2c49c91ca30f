#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/clock.h"
#include "base/status.h"

namespace drupe {

/// A prepared statement in use: bind in order, step, read columns in order. An error is kept and comes out of Step, so
/// that binds need no checks.
class Statement {
 public:
  virtual ~Statement() = default;

  virtual Statement& Bind(std::string_view text) = 0;
  virtual Statement& Bind(std::int64_t number) = 0;
  virtual Statement& Bind(double number) = 0;
  virtual Statement& BindNull() = 0;
  Statement& Bind(int number) { return Bind(static_cast<std::int64_t>(number)); }

  /// True: a row is there. False: the statement is done. Errors as Database's.
  virtual Result<bool> Step() = 0;
  /// Steps a statement that returns no rows.
  Status Run();

  /// Columns of the present row, counted from 0. A NULL reads as "", 0.
  virtual std::string Text(int column) const = 0;
  virtual std::int64_t Int(int column) const = 0;
  virtual double Real(int column) const = 0;
  virtual bool IsNull(int column) const = 0;
};

/// One step of a schema: SQL that takes it from version n to n + 1 (n = the place in the list).
using Migrations = std::vector<std::string>;

/// What a transaction must survive once it has returned.
enum class Durability {
  kPowerCut,     ///< fsynced
  kProcessDeath  ///< whatever ends this process and leaves its machine running
};

/// A column that holds text.
struct TextColumn {
  std::string table;
  std::string column;
};

/// The tables of one service, in SQLite or PostgreSQL. Statements are written once, in what the two have in common:
/// parameters are `?`, upserts ON CONFLICT, new keys come from RETURNING; tables are declared in SQLite's words
/// (INTEGER is 64 bits wide). Errors: 503 `database_in_use`, `database_unreachable`, 507 `disk_full`,
/// 500 `database_failed`, 500 `database_newer` (written by a later version of this software). Thread-safe.
class Database {
 public:
  virtual ~Database() = default;

  /// Brings the tables of `component` to the newest version. Steps already taken are never changed, only added to.
  Status Migrate(std::string_view component, const Migrations& migrations);

  /// Runs `body` in one transaction, with the connection to itself; commits when it returns OK, else rolls back.
  virtual Status Transaction(Durability durability, const std::function<Status()>& body) = 0;
  /// The statement for `sql`, compiled on first use and kept. Only inside Transaction.
  virtual Result<std::unique_ptr<Statement>> Prepare(std::string_view sql) = 0;
  /// Runs statements without parameters or rows. Only inside Transaction.
  virtual Status Execute(std::string_view sql) = 0;

  /// All columns of text. Only inside Transaction.
  Result<std::vector<TextColumn>> TextColumns();

  /// Whether other processes may work on these tables at the same time.
  virtual bool IsShared() const = 0;
  /// The time that all processes which work on these tables agree on.
  virtual const Clock& clock() const = 0;

  /// What is put after a SELECT whose rows are about to be changed: waits for others that change them, or leaves out
  /// the rows that others are changing.
  virtual std::string_view WaitForRows() const { return ""; }
  virtual std::string_view SkipTakenRows() const { return ""; }

  /// Only inside Transaction: once it commits, calls what the other processes have given to OnAnnouncement. A hint,
  /// which may be lost.
  virtual Status Announce() { return Status::Ok(); }
  /// `listener` is called on a thread of the database, in the place of the one before. Empty: nobody listens any more,
  /// and the call returns when the former listener is no longer being called.
  virtual void OnAnnouncement(std::function<void()> /*listener*/) {}

 protected:
  /// A query for (table, column) of all columns of text.
  virtual std::string_view TextColumnsQuery() const = 0;
  /// Makes concurrent migrations of several processes take turns, until the transaction ends.
  virtual Status LockForMigration() { return Status::Ok(); }
};

}  // namespace drupe
