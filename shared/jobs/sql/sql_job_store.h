#pragma once

#include <memory>

#include "base/clock.h"
#include "jobs/job_store.h"
#include "jobs/sql/database.h"

namespace drupe {

/// A JobStore in tables of `database`, which may hold other tables of the same service. Where one process owns the
/// database, jobs that are running when it is opened lost their worker with the former process: they are queued again
/// at once (or fail when their attempts are used up, so that a job which kills its process cannot do so for ever). In a
/// shared database the workers of other processes may be well; there the leases decide.
/// `database` must outlive the store; so must `clock`, which tests put in the place of the database's.
Result<std::unique_ptr<JobStore>> OpenJobStore(Database& database, const JobStoreOptions& options = {});
Result<std::unique_ptr<JobStore>> OpenJobStore(Database& database, const JobStoreOptions& options, const Clock& clock);

}  // namespace drupe
