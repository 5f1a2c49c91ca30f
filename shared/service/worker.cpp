#include "service/worker.h"

#include <unistd.h>

#include <array>

namespace drupe {

namespace {

const char* OutcomeName(const Status& outcome) {
  if (outcome.ok()) return "succeeded";
  return outcome.kind() == StatusKind::kCancelled ? "cancelled" : "failed";
}

}  // namespace

std::string WorkerName(const std::string& role) {
  std::array<char, 65> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '?';
  return role + "@" + host.data() + ":" + std::to_string(::getpid());
}

void CountAttempts(Metrics& metrics, JobRunnerOptions& options) {
  options.on_attempt = [&metrics](const Job& job, const Status& outcome, double wall_s) {
    metrics.Count("drupe_job_attempts_total", "Attempts at jobs that have ended.",
                  {{"kind", job.kind}, {"outcome", OutcomeName(outcome)}});
    metrics.ObserveSeconds("drupe_job_seconds", "Wall time of an attempt at a job.", {{"kind", job.kind}}, wall_s);
    if (outcome.ok() || outcome.kind() == StatusKind::kCancelled) return;
    metrics.Count("drupe_job_failures_total", "Failed attempts by the code of their error.",
                  {{"kind", job.kind}, {"code", outcome.code()}});
  };
  options.on_stage = [&metrics](const Job& job, const std::string& stage, double wall_s) {
    metrics.Count("drupe_stage_seconds_total", "Wall time spent in the stages of jobs.",
                  {{"kind", job.kind}, {"stage", stage}}, wall_s);
  };
}

}  // namespace drupe
