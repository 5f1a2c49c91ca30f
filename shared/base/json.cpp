#include "base/json.h"

#include <cmath>

namespace drupe {

Result<Json> ParseJson(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.max_bytes) {
    return Status(
        StatusKind::kTooLarge, "json_too_large",
        "the JSON has " + std::to_string(text.size()) + " bytes; the limit is " + std::to_string(limits.max_bytes));
  }
  bool too_deep = false;
  const auto guard = [&](int depth, Json::parse_event_t event, Json&) {
    using Event = Json::parse_event_t;
    if ((event == Event::array_start || event == Event::object_start) && depth >= limits.max_depth) {
      too_deep = true;
      return false;  // the nested value is discarded, so nothing deep is ever built
    }
    return true;
  };
  try {
    Json value = Json::parse(text, guard);
    if (too_deep) {
      return InvalidArgument("json_too_deep",
                             "the JSON is nested deeper than " + std::to_string(limits.max_depth) + " levels");
    }
    return value;
  } catch (const Json::parse_error& error) {
    return InvalidArgument("invalid_json", "not valid JSON near byte " + std::to_string(error.byte));
  } catch (const Json::exception&) {
    return InvalidArgument("invalid_json", "not valid JSON");
  }
}

std::string DumpJson(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::optional<double> FiniteNumber(const Json& json) {
  if (!json.is_number()) return std::nullopt;
  const double value = json.get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool ReadNumbers(const Json& json, std::span<double> out) {
  if (!json.is_array() || json.size() != out.size()) return false;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto number = FiniteNumber(json[i]);
    if (!number) return false;
    out[i] = *number;
  }
  return true;
}

}  // namespace drupe
