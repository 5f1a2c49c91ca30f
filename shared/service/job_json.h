#pragma once

#include <cstdint>
#include <string>

#include "base/json.h"
#include "base/status.h"
#include "http/request.h"
#include "jobs/job.h"

namespace drupe {

/// A job's time as replies show it: null for 0, "not yet".
Json TimeJson(std::int64_t unix_ms);
/// Why a job is dead: {"code", "message", and "field" if it has one}; null before. A failed attempt that is retried is
/// no error of the job yet.
Json JobErrorJson(const Job& job);
/// What a job shows of itself to whom it belongs: id, status, stage, progress, times, error.
Json JobJson(const Job& job);
/// The header Idempotency-Key, "" when absent. Errors: 400 `invalid_idempotency_key`.
Result<std::string> ReadIdempotencyKey(const Request& request);

}  // namespace drupe
