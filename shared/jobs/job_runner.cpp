#include "jobs/job_runner.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "base/clock.h"
#include "base/log.h"
#include "base/trace.h"
#include "jobs/running_job.h"

namespace drupe {

namespace {

using std::chrono::milliseconds;

/// Whether the same work may succeed at another time.
bool IsRetryable(StatusKind kind) {
  switch (kind) {
    case StatusKind::kInternal:
    case StatusKind::kDataLoss:
    case StatusKind::kUnavailable:
    case StatusKind::kTooManyRequests:
    case StatusKind::kInsufficientStorage:
      return true;
    default:
      return false;
  }
}

JobError ErrorOf(const Status& status) {
  return {status.code(), status.message(), status.field()};
}

}  // namespace

Status JobRunnerOptions::Check() const {
  if (workers < 1 || workers > 256) return InvalidArgument("invalid_option", "workers must be 1 to 256", "workers");
  if (heartbeat_ms < 1 || idle_poll_ms < 1 || drain_ms < 0) {
    return InvalidArgument("invalid_option", "heartbeat_ms and idle_poll_ms must be positive, drain_ms not negative");
  }
  if (lease_ms < 3 * heartbeat_ms) {
    return InvalidArgument("invalid_option", "lease_ms must be at least 3 heartbeats", "lease_ms");
  }
  return Status::Ok();
}

class JobRunner::Impl {
 public:
  Impl(JobStore& store, const JobRunnerOptions& options) : store_(store), options_(options) {}

  void Handle(const std::string& kind, Handler handler, std::vector<StageShare> stages) {
    kinds_.push_back(kind);
    entries_[kind] = {std::move(handler), std::move(stages)};
  }
  Status Start();
  void Stop(std::int64_t drain_ms);
  std::int64_t drain_ms() const { return options_.drain_ms; }
  int active() const;

 private:
  struct Entry {
    Handler handler;
    std::vector<StageShare> stages;
  };

  void WorkerLoop(int number);
  void HeartbeatLoop();
  void BeatAll();
  /// Lets the next heartbeat come at once, so that a stage is seen however short it is.
  void BeatNow();
  void Beat(RunningJob& running);
  void RunOne(const Job& job);
  Result<Json> CallHandler(const Entry& entry, const Job& job, const RunContext& context) const;
  /// Tells the store how the attempt ended.
  void Finish(const RunningJob& running, const Result<Json>& outcome);
  Status DeliverPatiently(const RunningJob& running, const Result<Json>& outcome);
  Status Deliver(const RunningJob& running, const Result<Json>& outcome);
  bool Register(const std::shared_ptr<RunningJob>& running);
  void Unregister(const std::shared_ptr<RunningJob>& running);
  std::vector<std::shared_ptr<RunningJob>> Running() const;
  void GiveBackRunning();

  JobStore& store_;
  const JobRunnerOptions options_;
  std::vector<std::string> kinds_;
  std::map<std::string, Entry> entries_;
  std::vector<std::thread> workers_;
  std::thread heart_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;  ///< running_ or a flag below
  std::set<std::shared_ptr<RunningJob>> running_;
  bool beat_now_ = false;   ///< a stage has begun
  bool draining_ = false;   ///< no further claims
  bool giving_up_ = false;  ///< the drain time is over
  bool finished_ = false;   ///< the workers have ended
};

Status JobRunner::Impl::Start() {
  DRUPE_RETURN_IF_ERROR(options_.Check());
  heart_ = std::thread([this] { HeartbeatLoop(); });
  for (int i = 0; i < options_.workers; ++i) workers_.emplace_back([this, i] { WorkerLoop(i); });
  return Status::Ok();
}

void JobRunner::Impl::Stop(std::int64_t drain_ms) {
  if (workers_.empty()) return;
  {
    std::unique_lock lock(mutex_);
    draining_ = true;
    store_.changes().Notify();  // wakes the idle workers
    changed_.wait_for(lock, milliseconds(drain_ms), [&] { return running_.empty(); });
    giving_up_ = true;
  }
  GiveBackRunning();
  for (std::thread& worker : workers_) worker.join();
  workers_.clear();
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  changed_.notify_all();
  heart_.join();
}

// Given back before the handlers have stopped: should the process be killed while one of them still works, the job is
// already where another process finds it, and a late outcome is refused by its attempt number.
void JobRunner::Impl::GiveBackRunning() {
  for (const auto& running : Running()) {
    running->GiveUp();
    const Status released = store_.Release(running->id(), running->attempt());
    Log(LogLevel::kInfo, "job given back", {{"job", running->id()}, {"outcome", released.ToString()}});
  }
}

int JobRunner::Impl::active() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(running_.size());
}

std::vector<std::shared_ptr<RunningJob>> JobRunner::Impl::Running() const {
  const std::lock_guard lock(mutex_);
  return {running_.begin(), running_.end()};
}

bool JobRunner::Impl::Register(const std::shared_ptr<RunningJob>& running) {
  const std::lock_guard lock(mutex_);
  if (!giving_up_) running_.insert(running);
  return !giving_up_;
}

void JobRunner::Impl::Unregister(const std::shared_ptr<RunningJob>& running) {
  {
    const std::lock_guard lock(mutex_);
    running_.erase(running);
  }
  changed_.notify_all();
}

void JobRunner::Impl::WorkerLoop(int number) {
  const std::string name = options_.worker_name + "-" + std::to_string(number);
  const auto draining = [&] {
    const std::lock_guard lock(mutex_);
    return draining_;
  };
  for (;;) {
    const std::uint64_t seen = store_.changes().version();  // before Claim, so that no submission is slept through
    if (draining()) return;
    const auto job = store_.Claim(kinds_, name, options_.lease_ms);
    if (job.ok() && job->has_value()) {
      RunOne(**job);
      continue;
    }
    if (!job.ok()) Log(LogLevel::kError, "no job could be claimed", {{"error", job.status().ToString()}});
    store_.changes().WaitBeyond(seen, milliseconds(options_.idle_poll_ms));
  }
}

void JobRunner::Impl::RunOne(const Job& job) {
  const TraceScope trace(job.trace);
  const Entry& entry = entries_.at(job.kind);
  const auto on_new_stage = [this, &job](const std::string& ended, double wall_s) {
    if (!ended.empty() && options_.on_stage) options_.on_stage(job, ended, wall_s);
    BeatNow();
  };
  const auto running = std::make_shared<RunningJob>(job.id, job.attempt, entry.stages, on_new_stage);
  if (!Register(running)) {
    (void)store_.Release(job.id, job.attempt);  // when this fails, the lease runs out
    return;
  }
  Log(LogLevel::kInfo, "job started", {{"job", job.id}, {"kind", job.kind}, {"attempt", job.attempt}});
  const Stopwatch watch;
  const Result<Json> outcome = CallHandler(entry, job, running->MakeContext(options_.threads_per_job));
  running->EndStages();
  const double wall_s = watch.WallSeconds();
  const Status& status = outcome.status();
  Log(status.ok() ? LogLevel::kInfo : LogLevel::kWarning, "job attempt ended",
      {{"job", job.id}, {"attempt", job.attempt}, {"wall_s", wall_s}, {"outcome", status.ToString()}});
  Finish(*running, outcome);
  Unregister(running);
  if (options_.on_attempt) options_.on_attempt(job, status, wall_s);
}

Result<Json> JobRunner::Impl::CallHandler(const Entry& entry, const Job& job, const RunContext& context) const {
  try {
    return entry.handler(job, context);
  } catch (const std::exception& error) {
    return Internal("unexpected_exception", error.what());
  } catch (...) {
    return Internal("unexpected_exception", "an exception of unknown type");
  }
}

void JobRunner::Impl::Finish(const RunningJob& running, const Result<Json>& outcome) {
  if (running.given_up()) return;
  const Status delivered = DeliverPatiently(running, outcome);
  if (delivered.ok()) return;
  // Refused: the attempt had been lost. Failed: the lease will run out, and the job be tried again.
  Log(LogLevel::kError, "outcome not recorded", {{"job", running.id()}, {"error", delivered.ToString()}});
}

// A database that is restarted is back within seconds, and an hour's work is worth waiting for: for as long as a lease
// lasts, after which the job may be another's.
Status JobRunner::Impl::DeliverPatiently(const RunningJob& running, const Result<Json>& outcome) {
  constexpr milliseconds kPause{500};
  const Stopwatch watch;
  Status delivered = Deliver(running, outcome);
  while (delivered.kind() == StatusKind::kUnavailable && !running.given_up() &&
         watch.WallSeconds() * 1000 < static_cast<double>(options_.lease_ms)) {
    std::this_thread::sleep_for(kPause);
    delivered = Deliver(running, outcome);
  }
  return delivered;
}

Status JobRunner::Impl::Deliver(const RunningJob& running, const Result<Json>& outcome) {
  if (!outcome.ok()) {
    const Status& status = outcome.status();
    if (status.kind() == StatusKind::kCancelled) return store_.MarkCancelled(running.id(), running.attempt());
    return store_.Fail(running.id(), running.attempt(), ErrorOf(status), IsRetryable(status.kind()));
  }
  const Status completed = store_.Complete(running.id(), running.attempt(), *outcome);
  if (completed.kind() != StatusKind::kTooLarge) return completed;
  return store_.Fail(running.id(), running.attempt(), ErrorOf(completed), false);
}

void JobRunner::Impl::HeartbeatLoop() {
  std::unique_lock lock(mutex_);
  while (!finished_) {
    changed_.wait_for(lock, milliseconds(options_.heartbeat_ms), [&] { return finished_ || beat_now_; });
    beat_now_ = false;
    lock.unlock();
    BeatAll();
    lock.lock();
  }
}

void JobRunner::Impl::BeatNow() {
  {
    const std::lock_guard lock(mutex_);
    beat_now_ = true;
  }
  changed_.notify_all();
}

void JobRunner::Impl::BeatAll() {
  for (const auto& running : Running()) {
    if (!running->given_up()) Beat(*running);
  }
}

void JobRunner::Impl::Beat(RunningJob& running) {
  const Result<bool> cancel = store_.Beat(running.id(), running.attempt(), running.Snapshot(options_.lease_ms));
  if (cancel.ok()) {
    if (*cancel) running.RequestStop();
    return;
  }
  // A conflict: either the attempt ended a moment ago, or it was lost, and the handler works for nothing.
  if (cancel.status().kind() == StatusKind::kConflict) {
    running.GiveUp();
  } else {
    Log(LogLevel::kWarning, "heartbeat failed", {{"job", running.id()}, {"error", cancel.status().ToString()}});
  }
}

JobRunner::JobRunner(JobStore& store, const JobRunnerOptions& options)
    : impl_(std::make_unique<Impl>(store, options)) {}

JobRunner::~JobRunner() {
  Stop();
}

void JobRunner::Handle(const std::string& kind, Handler handler, std::vector<StageShare> stages) {
  impl_->Handle(kind, std::move(handler), std::move(stages));
}

Status JobRunner::Start() {
  return impl_->Start();
}

void JobRunner::Stop() {
  impl_->Stop(impl_->drain_ms());
}

void JobRunner::Stop(std::int64_t drain_ms) {
  impl_->Stop(drain_ms);
}

int JobRunner::active() const {
  return impl_->active();
}

}  // namespace drupe
