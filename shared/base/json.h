#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/status.h"

namespace drupe {

/// Object keys keep the order in which they were written, so that reports read in the order the schema has.
using Json = nlohmann::ordered_json;

/// Limits on JSON from outside. nlohmann-json parses 200,000 nested arrays and then overflows the stack when the value
/// is copied or dumped, hence the cap on depth while parsing.
struct JsonLimits {
  std::size_t max_bytes = 1 << 20;
  int max_depth = 32;
};

/// Parses untrusted JSON. Errors: 400 `invalid_json` (syntax, with the byte), 400 `json_too_deep`, 413
/// `json_too_large`.
Result<Json> ParseJson(std::string_view text, const JsonLimits& limits = {});

/// Text of a JSON value; bytes that are not UTF-8 are replaced, never thrown about. indent < 0: one line.
std::string DumpJson(const Json& value, int indent = -1);

/// The number, unless `json` is something else or is not finite.
std::optional<double> FiniteNumber(const Json& json);
/// Reads an array of exactly out.size() finite numbers; false if `json` is something else.
bool ReadNumbers(const Json& json, std::span<double> out);

}  // namespace drupe
