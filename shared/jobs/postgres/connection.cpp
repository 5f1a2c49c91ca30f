#include "jobs/postgres/connection.h"

#include <array>

namespace drupe {

namespace {

constexpr int kOldestServer = 150000;

std::string Trimmed(const char* message) {
  std::string text = message == nullptr ? "" : message;
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

Status Unreachable(std::string_view doing, const std::string& why) {
  return {StatusKind::kUnavailable, "database_unreachable", std::string(doing) + ": " + why};
}

/// What an error of the server means; the classes are those of SQLSTATE (PostgreSQL 15, appendix A).
Status StatusFromServer(std::string_view doing, const PGresult* result) {
  const char* const field = PQresultErrorField(result, PG_DIAG_SQLSTATE);
  const std::string_view state = field == nullptr ? "" : field;
  const std::string message =
      std::string(doing) + ": " + Trimmed(PQresultErrorMessage(result)) + " (SQLSTATE " + std::string(state) + ")";
  if (state == "53100") return {StatusKind::kInsufficientStorage, "disk_full", message};
  const std::string_view kind = state.substr(0, 2);
  if (kind == "08" || kind == "57") return {StatusKind::kUnavailable, "database_unreachable", message};
  if (kind == "53" || kind == "40" || kind == "55") return {StatusKind::kUnavailable, "database_busy", message};
  return Internal("database_failed", message);
}

}  // namespace

PostgresConnection::~PostgresConnection() {
  Close();
}

void PostgresConnection::Close() {
  PQfinish(connection_);
  connection_ = nullptr;
  prepared_.clear();
}

// A server that has gone without a word is noticed within seconds; nothing waits for ever, neither for a lock nor for a
// statement, and a transaction of a process that froze is given up by the server: within seconds, since no other worker
// takes over the jobs whose rows it holds.
Status PostgresConnection::EnsureConnected() {
  if (is_up()) return Status::Ok();
  Close();
  const std::string options =
      "-c search_path=" + target_.schema +
      " -c statement_timeout=30s -c lock_timeout=10s"
      " -c idle_in_transaction_session_timeout=5s -c default_transaction_isolation=read\\ committed";
  const std::array<const char*, 8> names = {
      "connect_timeout",  "tcp_user_timeout", "keepalives_idle", "client_encoding",
      "application_name", "options",          "dbname",          nullptr};
  const std::array<const char*, 8> values = {
      "5", "15000", "10", "UTF8", "drupe", options.c_str(), target_.url.c_str(), nullptr};
  connection_ = PQconnectdbParams(names.data(), values.data(), /*expand_dbname=*/1);
  if (!is_up()) return Unreachable("connect to PostgreSQL", Trimmed(PQerrorMessage(connection_)));
  PQsetNoticeProcessor(
      connection_, [](void*, const char*) {}, nullptr);
  if (PQserverVersion(connection_) < kOldestServer) {
    return Internal("database_too_old", "PostgreSQL 15 or later is needed; the server's version is " +
                                            std::to_string(PQserverVersion(connection_) / 10000));
  }
  return Status::Ok();
}

Result<PgResult> PostgresConnection::Check(PGresult* raw, std::string_view doing) {
  PgResult result(raw);
  const ExecStatusType outcome = PQresultStatus(raw);
  if (outcome == PGRES_TUPLES_OK || outcome == PGRES_COMMAND_OK || outcome == PGRES_EMPTY_QUERY) return result;
  if (!is_up()) return Unreachable(doing, Trimmed(PQerrorMessage(connection_)));
  return StatusFromServer(doing, raw);
}

Result<PgResult> PostgresConnection::Run(const std::string& sql) {
  return Check(PQexec(connection_, sql.c_str()), sql);
}

Result<std::string> PostgresConnection::PreparedName(const std::string& sql) {
  if (const auto known = prepared_.find(sql); known != prepared_.end()) return known->second;
  std::string name = "s" + std::to_string(prepared_.size());
  const auto prepared = Check(PQprepare(connection_, name.c_str(), sql.c_str(), 0, nullptr), sql);
  if (!prepared.ok()) return prepared.status();
  prepared_[sql] = name;
  return name;
}

Result<PgResult> PostgresConnection::RunPrepared(const std::string& sql, const std::vector<const char*>& parameters) {
  DRUPE_ASSIGN_OR_RETURN(const std::string name, PreparedName(sql));
  return Check(PQexecPrepared(connection_, name.c_str(), static_cast<int>(parameters.size()), parameters.data(),
                              nullptr, nullptr, /*resultFormat=*/0),
               sql);
}

}  // namespace drupe
