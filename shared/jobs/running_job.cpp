#include "jobs/running_job.h"

#include <algorithm>
#include <utility>

namespace drupe {

RunningJob::RunningJob(std::string id, std::int64_t attempt, const std::vector<StageShare>& stages,
                       OnNewStage on_new_stage)
    : id_(std::move(id)), attempt_(attempt), stages_(stages), on_new_stage_(std::move(on_new_stage)) {}

RunContext RunningJob::MakeContext(int threads) {
  RunContext context;
  context.progress = [this](std::string_view stage, double fraction) { Report(stage, fraction); };
  context.cancelled = [this] { return stop_.load(); };
  context.threads = threads;
  return context;
}

Heartbeat RunningJob::Snapshot(std::int64_t lease_ms) const {
  const std::lock_guard lock(mutex_);
  return {.stage = stage_, .progress = progress_, .lease_ms = lease_ms};
}

void RunningJob::Report(std::string_view stage, double fraction) {
  const double overall = OverallProgress(stage, std::clamp(fraction, 0.0, 1.0));
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    is_new = stage_ != stage;
    progress_ = std::max(progress_, overall);
  }
  if (is_new) BeginStage(stage);
}

void RunningJob::BeginStage(std::string_view stage) {
  std::string ended;
  double wall_s = 0;
  {
    const std::lock_guard lock(mutex_);
    ended = std::exchange(stage_, stage);
    wall_s = std::exchange(stage_watch_, Stopwatch()).WallSeconds();
  }
  on_new_stage_(ended, wall_s);
}

void RunningJob::EndStages() {
  std::string last;
  {
    const std::lock_guard lock(mutex_);
    last = stage_;  // stays, so that a job which failed says where
  }
  BeginStage(last);
}

double RunningJob::OverallProgress(std::string_view stage, double fraction) const {
  if (stages_.empty()) return fraction;
  double total = 0;
  double done = -1;
  for (const StageShare& known : stages_) {
    if (known.stage == stage) done = total + known.share * fraction;
    total += known.share;
  }
  return done / total;
}

}  // namespace drupe
