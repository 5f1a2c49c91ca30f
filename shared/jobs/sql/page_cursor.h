#pragma once

#include <cstdint>
#include <string>

#include "base/status.h"

namespace drupe {

/// The row before which a page of a list starts, newest first: beyond every row when `cursor` is empty. Errors:
/// `invalid_cursor` unless a former page returned it.
Result<std::int64_t> ParseCursor(const std::string& cursor);

}  // namespace drupe
