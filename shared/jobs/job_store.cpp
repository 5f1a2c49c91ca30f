#include "jobs/job_store.h"

#include <algorithm>

namespace drupe {

Status JobStoreOptions::Check() const {
  if (first_backoff_ms < 0 || max_backoff_ms < first_backoff_ms) {
    return InvalidArgument("invalid_option", "backoff must satisfy 0 <= first_backoff_ms <= max_backoff_ms");
  }
  if (max_queued < 1) return InvalidArgument("invalid_option", "max_queued must be at least 1", "max_queued");
  return Status::Ok();
}

std::int64_t JobStoreOptions::BackoffMs(int failures) const {
  // Beyond 2^40 the maximum has long been reached; the cap keeps the shift defined.
  const int doublings = std::clamp(failures - 1, 0, 40);
  if (first_backoff_ms > (max_backoff_ms >> doublings)) return max_backoff_ms;
  return first_backoff_ms << doublings;
}

}  // namespace drupe
