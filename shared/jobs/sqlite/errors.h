#pragma once

#include <string_view>

#include "base/status.h"

struct sqlite3;

namespace drupe {

/// What the last error of `connection` means: 507 `disk_full` or 500 `database_failed` with SQLite's words; `doing`
/// says what was attempted.
Status StatusFromSqlite(sqlite3* connection, std::string_view doing);

}  // namespace drupe
