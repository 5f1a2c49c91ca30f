#include "service/job_json.h"

#include <algorithm>

#include "base/clock.h"

namespace drupe {
namespace {

constexpr std::size_t kMaxKeyBytes = 200;

}  // namespace

Json TimeJson(std::int64_t unix_ms) {
  return unix_ms == 0 ? Json() : Json(FormatUtc(unix_ms));
}

Json JobErrorJson(const Job& job) {
  if (!job.error || job.state != JobState::kFailed) return nullptr;
  Json error = {{"code", job.error->code}, {"message", job.error->message}};
  if (!job.error->field.empty()) error["field"] = job.error->field;
  return error;
}

Json JobJson(const Job& job) {
  return {{"id", job.id},
          {"status", JobStateName(job.state)},
          {"stage", job.stage},
          {"progress", job.progress},
          {"created_at", TimeJson(job.created_ms)},
          {"started_at", TimeJson(job.started_ms)},
          {"finished_at", TimeJson(job.finished_ms)},
          {"error", JobErrorJson(job)}};
}

Result<std::string> ReadIdempotencyKey(const Request& request) {
  const std::string key(request.Header("Idempotency-Key"));
  if (request.headers.count("Idempotency-Key") == 0) return key;
  const bool printable = std::all_of(key.begin(), key.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
  if (printable && !key.empty() && key.size() <= kMaxKeyBytes) return key;
  return InvalidArgument("invalid_idempotency_key", "Idempotency-Key must be 1 to 200 printable characters",
                         "Idempotency-Key");
}

}  // namespace drupe
