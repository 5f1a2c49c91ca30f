#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "jobs/sql/database.h"

namespace drupe {

/// Opens the tables of `service` ("reconstruction") where `url` says:
///   - empty: SQLite, in `data`/SERVICE.db;
///   - sqlite:PATH: SQLite, in that file;
///   - postgres://... or postgresql://...: the schema drupe_SERVICE of that PostgreSQL database.
/// Errors: 400 `invalid_jobs_url`, and those of Database.
Result<std::unique_ptr<Database>> OpenDatabase(const std::string& url, const std::filesystem::path& data,
                                               const std::string& service);

}  // namespace drupe
