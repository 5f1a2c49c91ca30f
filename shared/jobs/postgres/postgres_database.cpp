#include "jobs/postgres/postgres_database.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "jobs/postgres/announcements.h"
#include "jobs/postgres/connection.h"
#include "jobs/postgres/dialect.h"
#include "jobs/postgres/statement.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxSchemaBytes = 40;
/// Any number that other users of the database are unlikely to lock.
constexpr const char* kMigrationLock = "SELECT pg_advisory_xact_lock(7305447216)";
constexpr const char* kTime = "SELECT (extract(epoch FROM clock_timestamp()) * 1000)::bigint";

std::int64_t SteadyMs() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

/// The server's time, carried on by this machine's steady clock between transactions.
class ServerClock : public Clock {
 public:
  std::int64_t NowMs() const override { return SteadyMs() + ahead_ms_; }
  void Set(std::int64_t server_ms) { ahead_ms_ = server_ms - SteadyMs(); }

 private:
  std::atomic<std::int64_t> ahead_ms_{0};
};

class PostgresDatabase : public Database {
 public:
  explicit PostgresDatabase(PostgresTarget target) : target_(std::move(target)), connection_(target_) {}

  Status Open();
  Status Transaction(Durability durability, const std::function<Status()>& body) override;
  Result<std::unique_ptr<Statement>> Prepare(std::string_view sql) override {
    return std::unique_ptr<Statement>(std::make_unique<PostgresStatement>(connection_, NumberParameters(sql)));
  }
  Status Execute(std::string_view sql) override { return connection_.Run(TranslateSchema(sql)).status(); }
  bool IsShared() const override { return true; }
  const Clock& clock() const override { return clock_; }
  std::string_view WaitForRows() const override { return " FOR UPDATE"; }
  std::string_view SkipTakenRows() const override { return " FOR UPDATE SKIP LOCKED"; }
  Status Announce() override {
    announces_ = true;
    return Status::Ok();
  }
  void OnAnnouncement(std::function<void()> listener) override {
    announcements_.reset();
    if (!listener) return;
    announcements_ = std::make_unique<Announcements>(target_, channel(), server_pid_, std::move(listener));
  }

 protected:
  std::string_view TextColumnsQuery() const override {
    return "SELECT table_name, column_name FROM information_schema.columns"
           " WHERE table_schema = current_schema() AND data_type = 'text'";
  }
  Status LockForMigration() override { return connection_.Run(kMigrationLock).status(); }

 private:
  /// Starts a transaction and learns the server's time; connects again when the connection was lost meanwhile.
  Status Begin(Durability durability);
  Status TryBegin(Durability durability);
  std::string channel() const { return target_.schema; }

  const PostgresTarget target_;
  ServerClock clock_;
  std::mutex mutex_;
  PostgresConnection connection_;
  bool announces_ = false;  ///< whether the present transaction does
  std::atomic<int> server_pid_{0};
  std::unique_ptr<Announcements> announcements_;
};

Status PostgresDatabase::Open() {
  return Transaction(Durability::kPowerCut, [&] {
    const Status locked = LockForMigration();
    return locked.ok() ? Execute("CREATE SCHEMA IF NOT EXISTS " + target_.schema) : locked;
  });
}

Status PostgresDatabase::TryBegin(Durability durability) {
  DRUPE_RETURN_IF_ERROR(connection_.EnsureConnected());
  server_pid_ = connection_.server_pid();
  const std::string begin =
      durability == Durability::kPowerCut ? "BEGIN; " : "BEGIN; SET LOCAL synchronous_commit = off; ";
  DRUPE_ASSIGN_OR_RETURN(const PgResult time, connection_.Run(begin + kTime));
  clock_.Set(std::stoll(PQgetvalue(time.get(), 0, 0)));
  return Status::Ok();
}

Status PostgresDatabase::Begin(Durability durability) {
  const bool was_up = connection_.is_up();
  const Status begun = TryBegin(durability);
  // A connection that stood idle may have been lost long ago; nothing has been done on it yet.
  return !begun.ok() && was_up && !connection_.is_up() ? TryBegin(durability) : begun;
}

Status PostgresDatabase::Transaction(Durability durability, const std::function<Status()>& body) {
  const std::lock_guard lock(mutex_);
  DRUPE_RETURN_IF_ERROR(Begin(durability));
  announces_ = false;
  Status outcome = body();
  // In one message, so that it costs no further way to the server and back.
  if (outcome.ok()) outcome = connection_.Run(announces_ ? "NOTIFY " + channel() + "; COMMIT" : "COMMIT").status();
  // A connection on which even that fails is in no known state.
  if (!outcome.ok() && connection_.is_up() && !connection_.Run("ROLLBACK").ok()) connection_.Close();
  return outcome;
}

bool IsSchemaName(const std::string& name) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= kMaxSchemaBytes && std::all_of(name.begin(), name.end(), allowed);
}

}  // namespace

Result<std::unique_ptr<Database>> OpenPostgresDatabase(const std::string& url, const std::string& schema) {
  if (!IsSchemaName(schema)) return InvalidArgument("invalid_jobs_url", "a schema is named by [a-z0-9_]", "jobs_url");
  auto database = std::make_unique<PostgresDatabase>(PostgresTarget{url, schema});
  DRUPE_RETURN_IF_ERROR(database->Open());
  return std::unique_ptr<Database>(std::move(database));
}

}  // namespace drupe
