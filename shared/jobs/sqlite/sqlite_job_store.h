#pragma once

#include <memory>

#include "base/clock.h"
#include "jobs/job_store.h"
#include "jobs/sqlite/database.h"

namespace drupe {

/// A JobStore in tables of `database`, which may hold other tables of the same service. Since one process owns the
/// file, jobs that are running when it is opened lost their worker with the former process: they are queued again at
/// once (or fail when their attempts are used up, so that a job which kills its process cannot do so for ever).
/// `database` and `clock` must outlive the store.
Result<std::unique_ptr<JobStore>> OpenSqliteJobStore(SqliteDatabase& database, const JobStoreOptions& options = {},
                                                     const Clock& clock = Clock::System());

}  // namespace drupe
