#pragma once

#include <functional>
#include <string>

#include "base/json.h"
#include "base/status.h"
#include "http/request.h"
#include "jobs/job_store.h"

namespace drupe {

/// The page of the jobs of a kind that a request asks for by `status`, `limit` (1 to 200, else 50) and `cursor`:
/// {`name`: what `describe` says of each, "next_cursor": text, or null on the last page}. Errors: 400 for a bad query,
/// and those of the store and of `describe`.
Result<Json> JobPageJson(const Request& request, JobStore& jobs, const std::string& kind, const std::string& name,
                         const std::function<Result<Json>(const Job&)>& describe);

}  // namespace drupe
