#pragma once

#include <libpq-fe.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"

namespace drupe {

struct PgResultDeleter {
  void operator()(PGresult* result) const { PQclear(result); }
};
using PgResult = std::unique_ptr<PGresult, PgResultDeleter>;

/// Where the tables of a service are.
struct PostgresTarget {
  std::string url;     ///< postgres://USER@HOST/DATABASE or any other connection string of libpq
  std::string schema;  ///< that holds the service's tables; a name of [a-z0-9_]
};

/// One connection to the server, opened again after it was lost. Not thread-safe.
class PostgresConnection {
 public:
  explicit PostgresConnection(PostgresTarget target) : target_(std::move(target)) {}
  ~PostgresConnection();
  PostgresConnection(const PostgresConnection&) = delete;
  PostgresConnection& operator=(const PostgresConnection&) = delete;

  /// Connects unless a connection is up. Errors: 503 `database_unreachable`, 500 `database_too_old`.
  Status EnsureConnected();
  /// Runs SQL without parameters, several statements too; the result of the last one.
  Result<PgResult> Run(const std::string& sql);
  /// Runs one statement with parameters in text form (null pointer: NULL), prepared on first use and kept.
  Result<PgResult> RunPrepared(const std::string& sql, const std::vector<const char*>& parameters);

  PGconn* handle() { return connection_; }
  /// The server's process behind this connection; 0 when there is none.
  int server_pid() const { return connection_ == nullptr ? 0 : PQbackendPID(connection_); }
  bool is_up() const { return connection_ != nullptr && PQstatus(connection_) == CONNECTION_OK; }
  void Close();

 private:
  Result<PgResult> Check(PGresult* result, std::string_view doing);
  Result<std::string> PreparedName(const std::string& sql);

  const PostgresTarget target_;
  PGconn* connection_ = nullptr;
  std::map<std::string, std::string> prepared_;  ///< SQL -> name on the server
};

}  // namespace drupe
