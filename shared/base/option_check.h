#pragma once

#include <string>

#include "base/status.h"

/// What the Check() of option structs return: 400 `invalid_option`, "FIELD must be RANGE".
namespace drupe {

inline Status RefuseOption(const std::string& field, const std::string& range) {
  return InvalidArgument("invalid_option", field + " must be " + range, field);
}

/// Ok if `ok`, as RefuseOption if not.
inline Status CheckOption(bool ok, const char* field, const char* range) {
  return ok ? Status::Ok() : RefuseOption(field, range);
}

}  // namespace drupe
