#include "capture/calibration/checkerboard.h"

#include <string>
#include <utility>

namespace drupe {
namespace {

Status Invalid(std::string message, std::string field) {
  return InvalidArgument("invalid_pattern", std::move(message), std::move(field));
}

bool IsCount(const Json& json) {
  return json.is_number_integer() && json.get<std::int64_t>() >= 3 && json.get<std::int64_t>() <= 50;
}

}  // namespace

Result<Checkerboard> ParseCheckerboard(const Json& json) {
  if (!json.is_object()) return Invalid("the pattern must be a JSON object", "pattern");
  if (json.value("pattern", Json()) != "checkerboard") {
    return Invalid("the only pattern is \"checkerboard\"", "pattern");
  }
  const Json counts = json.value("inner_corners", Json());
  if (!counts.is_array() || counts.size() != 2 || !IsCount(counts[0]) || !IsCount(counts[1])) {
    return Invalid("must be two whole numbers from 3 to 50: inner corners a row and a column", "inner_corners");
  }
  const Json square = json.value("square_mm", Json());
  if (!square.is_number() || !(square.get<double>() >= 0.01 && square.get<double>() <= 1000)) {
    return Invalid("must be a number of millimetres from 0.01 to 1000", "square_mm");
  }
  return Checkerboard{counts[0].get<int>(), counts[1].get<int>(), square.get<double>()};
}

Json ToJson(const Checkerboard& pattern) {
  return {{"pattern", "checkerboard"},
          {"inner_corners", Json::array({pattern.columns, pattern.rows})},
          {"square_mm", pattern.square_mm}};
}

}  // namespace drupe
