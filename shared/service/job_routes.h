#pragma once

#include "http/router.h"
#include "jobs/job_store.h"

namespace drupe {

/// For operators: GET /jobs lists jobs with the reasons of their failures (the dead letters with ?state=failed),
/// GET /jobs/ID gives one with its history, POST /jobs/ID/retry queues an ended one again, POST /jobs/ID/cancel stops
/// one. `jobs` must outlive the router.
void AddJobRoutes(Router& router, JobStore& jobs);

}  // namespace drupe
