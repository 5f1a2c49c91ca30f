#include "jobs/postgres/statement.h"

#include <array>
#include <charconv>

#include "jobs/postgres/dialect.h"

namespace drupe {

namespace {

/// The number in its shortest form that reads back as the same.
template <typename Number>
std::string NumberText(Number number) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  return {buffer.data(), end};
}

template <typename Number>
Number ParseNumber(const std::string& text) {
  Number number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

}  // namespace

Statement& PostgresStatement::Bind(std::string_view text) {
  parameters_.emplace_back(StorableText(text));
  return *this;
}

Statement& PostgresStatement::Bind(std::int64_t number) {
  parameters_.emplace_back(NumberText(number));
  return *this;
}

Statement& PostgresStatement::Bind(double number) {
  parameters_.emplace_back(NumberText(number));
  return *this;
}

Statement& PostgresStatement::BindNull() {
  parameters_.emplace_back(std::nullopt);
  return *this;
}

Result<bool> PostgresStatement::Step() {
  if (rows_ == nullptr) {
    std::vector<const char*> values;
    for (const auto& parameter : parameters_) values.push_back(parameter ? parameter->c_str() : nullptr);
    DRUPE_ASSIGN_OR_RETURN(rows_, connection_.RunPrepared(sql_, values));
  }
  return ++row_ < PQntuples(rows_.get());
}

std::string PostgresStatement::Text(int column) const {
  return {PQgetvalue(rows_.get(), row_, column), static_cast<std::size_t>(PQgetlength(rows_.get(), row_, column))};
}

std::int64_t PostgresStatement::Int(int column) const {
  return ParseNumber<std::int64_t>(Text(column));
}

double PostgresStatement::Real(int column) const {
  return ParseNumber<double>(Text(column));
}

bool PostgresStatement::IsNull(int column) const {
  return PQgetisnull(rows_.get(), row_, column) != 0;
}

}  // namespace drupe
