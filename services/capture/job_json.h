#pragma once

#include <string>

#include "base/json.h"
#include "base/status.h"
#include "http/request.h"
#include "jobs/job.h"

namespace drupe {

/// What every job of this service shows of itself: id, status, stage, progress, times, error.
Json JobJson(const Job& job);
/// The header Idempotency-Key, "" when absent. Errors: 400 `invalid_idempotency_key`.
Result<std::string> ReadIdempotencyKey(const Request& request);

}  // namespace drupe
