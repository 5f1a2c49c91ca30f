#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "base/clock.h"
#include "base/run_context.h"
#include "jobs/job_runner.h"

namespace drupe {

/// An attempt in progress: what the handler's thread reports and what the heartbeat thread tells it.
class RunningJob {
 public:
  /// Told on the handler's thread that a stage begins; `ended` is the one before ("" for none) and its wall time.
  using OnNewStage = std::function<void(const std::string& ended, double wall_s)>;

  /// `stages` must outlive the attempt.
  RunningJob(std::string id, std::int64_t attempt, const std::vector<StageShare>& stages, OnNewStage on_new_stage);

  const std::string& id() const { return id_; }
  std::int64_t attempt() const { return attempt_; }

  /// The context for the handler; it must not outlive this object.
  RunContext MakeContext(int threads);
  /// Stage and progress as last reported.
  Heartbeat Snapshot(std::int64_t lease_ms) const;

  /// Says that the handler has returned, which ends its last stage.
  void EndStages();

  /// Tells the handler to stop. `GiveUp` also says that its outcome no longer counts: the attempt is over in the store.
  void RequestStop() { stop_ = true; }
  void GiveUp() { given_up_ = stop_ = true; }
  bool given_up() const { return given_up_; }

 private:
  void Report(std::string_view stage, double fraction);
  void BeginStage(std::string_view stage);
  /// The job's progress when `fraction` of `stage` is done; negative for a stage that has no share.
  double OverallProgress(std::string_view stage, double fraction) const;

  const std::string id_;
  const std::int64_t attempt_;
  const std::vector<StageShare>& stages_;
  const OnNewStage on_new_stage_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> given_up_{false};
  mutable std::mutex mutex_;
  std::string stage_;
  Stopwatch stage_watch_;
  double progress_ = 0;  ///< never decreases
};

}  // namespace drupe
