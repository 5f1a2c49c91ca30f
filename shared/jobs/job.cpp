#include "jobs/job.h"

#include <array>

namespace drupe {

namespace {

constexpr std::array<const char*, 5> kStateNames = {"queued", "running", "succeeded", "failed", "cancelled"};
constexpr std::size_t kMaxNameBytes = 64;
constexpr std::size_t kMaxKeyBytes = 200;
constexpr int kMaxAttempts = 100;

Status OutOfRange(std::string_view field, std::string_view range) {
  return InvalidArgument("invalid_job", std::string(field) + " must have " + std::string(range), std::string(field));
}

}  // namespace

const char* JobStateName(JobState state) {
  return kStateNames.at(static_cast<std::size_t>(state));
}

Result<JobState> ParseJobState(std::string_view name) {
  for (std::size_t i = 0; i < kStateNames.size(); ++i) {
    if (name == kStateNames.at(i)) return static_cast<JobState>(i);
  }
  return InvalidArgument("invalid_state", "a state is queued, running, succeeded, failed or cancelled", "state");
}

bool IsTerminal(JobState state) {
  return state != JobState::kQueued && state != JobState::kRunning;
}

Status JobSpec::Check() const {
  if (kind.empty() || kind.size() > kMaxNameBytes) return OutOfRange("kind", "1 to 64 bytes");
  if (id_prefix.empty() || id_prefix.size() > kMaxNameBytes) return OutOfRange("id_prefix", "1 to 64 bytes");
  if (subject.size() > kMaxNameBytes) return OutOfRange("subject", "at most 64 bytes");
  if (idempotency_key.size() > kMaxKeyBytes) return OutOfRange("idempotency_key", "at most 200 bytes");
  if (max_attempts < 1 || max_attempts > kMaxAttempts) return OutOfRange("max_attempts", "a value from 1 to 100");
  return Status::Ok();
}

}  // namespace drupe
