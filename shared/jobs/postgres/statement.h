#pragma once

#include <optional>
#include <string>
#include <vector>

#include "jobs/postgres/connection.h"
#include "jobs/sql/database.h"

namespace drupe {

/// Runs on the first Step, which fetches all rows.
class PostgresStatement : public Statement {
 public:
  /// `sql` has numbered parameters; `connection` must outlive the statement.
  PostgresStatement(PostgresConnection& connection, std::string sql) : connection_(connection), sql_(std::move(sql)) {}

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
  PostgresConnection& connection_;
  const std::string sql_;
  std::vector<std::optional<std::string>> parameters_;
  PgResult rows_;
  int row_ = -1;
};

}  // namespace drupe
