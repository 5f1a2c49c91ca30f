#pragma once

#include <memory>
#include <string>

#include "jobs/sql/database.h"

namespace drupe {

/// The tables of one service in a schema of a PostgreSQL database (15 or later), which any number of processes on any
/// number of machines share. One connection behind a mutex does the work, another listens for announcements; both are
/// opened again when they were lost. Time is the server's, so that machines whose clocks differ agree on leases.
///
/// A power cut of the server's machine may undo what was committed with Durability::kProcessDeath within the last
/// second. A claim that is undone so leaves a worker that knows nothing of it: the job is claimed again, under the same
/// number, and whichever of the two ends it first ends it; the other is refused.
///
/// `url`: postgres://USER@HOST:PORT/DATABASE or another connection string of libpq, which also reads PGPASSFILE.
/// `schema`: 1 to 40 characters of [a-z0-9_], made when it is missing. Errors: 400 `invalid_jobs_url`, and those of
/// Database.
Result<std::unique_ptr<Database>> OpenPostgresDatabase(const std::string& url, const std::string& schema);

}  // namespace drupe
