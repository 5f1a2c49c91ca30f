#pragma once

#include <string>

namespace drupe {

/// For tests: a PostgreSQL server of their own, run by tests/postgres/cluster.py until the process ends.
class TemporaryPostgres {
 public:
  /// That of this process, started on first use.
  static const TemporaryPostgres& Get();

  /// Empty when there is no server.
  const std::string& url() const { return url_; }
  /// Why there is none.
  const std::string& reason() const { return reason_; }

 private:
  TemporaryPostgres();

  std::string url_;
  std::string reason_;
};

}  // namespace drupe
