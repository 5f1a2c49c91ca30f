#include "jobs/job_runner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "base/ids.h"
#include "jobs/fake_clock.h"
#include "jobs/sql/sql_job_store.h"
#include "jobs/sqlite/database.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr std::chrono::seconds kPatience{30};

class JobRunnerTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(directory_);
    database_ = SqliteDatabase::Open(directory_ / "jobs.db").value();
    store_ = OpenJobStore(*database_, {.first_backoff_ms = 1, .max_backoff_ms = 1}).value();
  }
  void TearDown() override {
    runner_.reset();
    store_.reset();
    database_.reset();
    fs::remove_all(directory_);
  }

  /// Starts a runner for kind "work".
  void Start(JobRunner::Handler handler, std::vector<StageShare> stages = {}, JobRunnerOptions options = {}) {
    options.heartbeat_ms = 5;
    options.idle_poll_ms = 5;
    runner_ = std::make_unique<JobRunner>(*store_, options);
    runner_->Handle("work", std::move(handler), std::move(stages));
    ASSERT_TRUE(runner_->Start().ok());
  }
  std::string Submit() { return store_->Submit({.kind = "work", .payload = {{"x", 20}}}).value().id; }
  /// Waits until `condition` holds for the job and returns it.
  Job WaitFor(const std::string& id, const std::function<bool(const Job&)>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    for (;;) {
      const std::uint64_t seen = store_->changes().version();
      Job job = store_->Get(id).value();
      if (condition(job)) return job;
      if (std::chrono::steady_clock::now() > deadline) {
        ADD_FAILURE() << "job stays " << JobStateName(job.state);
        return job;
      }
      store_->changes().WaitBeyond(seen, milliseconds(100));
    }
  }
  Job WaitForEnd(const std::string& id) {
    return WaitFor(id, [](const Job& job) { return IsTerminal(job.state); });
  }
  /// A handler that works until it is told to stop.
  static Result<Json> WorkUntilStopped(const Job&, const RunContext& context) {
    while (!context.IsCancelled()) std::this_thread::sleep_for(milliseconds(1));
    return Cancelled();
  }

  const fs::path directory_ = fs::temp_directory_path() / NewId("runnertest");
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<JobStore> store_;
  std::unique_ptr<JobRunner> runner_;
};

TEST_F(JobRunnerTest, DeliversResults) {
  Start([](const Job& job, const RunContext&) -> Result<Json> { return Json{{"y", job.payload["x"].get<int>() + 1}}; });
  std::vector<std::string> ids;
  for (int i = 0; i < 20; ++i) ids.push_back(Submit());
  for (const std::string& id : ids) EXPECT_EQ(WaitForEnd(id).result, Json({{"y", 21}}));
}

TEST_F(JobRunnerTest, TellsOfEveryStageThatEnded) {
  std::mutex mutex;
  std::vector<std::string> ended;
  JobRunnerOptions options;
  options.on_stage = [&](const Job&, const std::string& stage, double wall_s) {
    const std::lock_guard lock(mutex);
    ended.push_back(stage);
    EXPECT_GE(wall_s, 0);
  };
  Start(
      [](const Job&, const RunContext& context) -> Result<Json> {
        for (const char* stage : {"features", "dense"}) {
          context.Report(stage, 0);
          context.Report(stage, 1);
        }
        return Json(1);
      },
      {}, options);
  WaitForEnd(Submit());
  const std::lock_guard lock(mutex);
  EXPECT_EQ(ended, (std::vector<std::string>{"features", "dense"}));
}

TEST_F(JobRunnerTest, RunsSeveralJobsAtOnce) {
  std::atomic<int> inside{0};
  Start(
      [&](const Job&, const RunContext& context) -> Result<Json> {
        ++inside;
        while (inside < 3 && !context.IsCancelled()) std::this_thread::sleep_for(milliseconds(1));
        return Json(1);
      },
      {}, {.workers = 3});
  const std::vector<std::string> ids = {Submit(), Submit(), Submit()};
  for (const std::string& id : ids) EXPECT_EQ(WaitForEnd(id).state, JobState::kSucceeded);
}

TEST_F(JobRunnerTest, RetriesWhatMayPassAndGivesUpWhatCannot) {
  std::atomic<int> calls{0};
  Start([&](const Job&, const RunContext&) -> Result<Json> {
    if (++calls < 3) return Internal("shaky", "");
    return Unprocessable("too_few_images", "3 are needed");
  });
  const Job job = WaitForEnd(Submit());
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.attempt, 3);
  EXPECT_EQ(job.error->code, "too_few_images");
}

TEST_F(JobRunnerTest, ExceptionsAreFailuresOfTheAttempt) {
  Start([](const Job& job, const RunContext&) -> Result<Json> {
    if (job.attempt == 1) throw std::runtime_error("oops");
    return Json(1);
  });
  const Job job = WaitForEnd(Submit());
  EXPECT_EQ(job.state, JobState::kSucceeded);
  EXPECT_EQ(store_->History(job.id).value().at(2).reason, "retry: unexpected_exception");
}

TEST_F(JobRunnerTest, ShowsStageAndProgressByTheShareOfTheStages) {
  std::atomic<bool> seen{false};
  Start(
      [&](const Job&, const RunContext& context) -> Result<Json> {
        context.Report("dense", 0.5);
        while (!seen) std::this_thread::sleep_for(milliseconds(1));
        return Json(1);
      },
      {{"sparse", 3}, {"dense", 1}});
  const std::string id = Submit();
  const Job running = WaitFor(id, [](const Job& job) { return job.stage == "dense"; });
  EXPECT_DOUBLE_EQ(running.progress, 3.5 / 4);
  seen = true;
  EXPECT_EQ(WaitForEnd(id).progress, 1);
}

TEST_F(JobRunnerTest, ShowsANewStageWithoutWaitingForTheHeartbeat) {
  std::atomic<bool> seen{false};
  runner_ = std::make_unique<JobRunner>(*store_, JobRunnerOptions{.lease_ms = 600'000, .heartbeat_ms = 200'000});
  runner_->Handle("work", [&](const Job&, const RunContext& context) -> Result<Json> {
    context.Report("dense", 0.5);
    while (!seen) std::this_thread::sleep_for(milliseconds(1));
    return Json(1);
  });
  ASSERT_TRUE(runner_->Start().ok());
  const std::string id = Submit();
  EXPECT_EQ(WaitFor(id, [](const Job& job) { return job.stage == "dense"; }).stage, "dense");
  seen = true;
  WaitForEnd(id);
}

TEST_F(JobRunnerTest, CancelReachesTheHandler) {
  Start(WorkUntilStopped);
  const std::string id = Submit();
  WaitFor(id, [](const Job& job) { return job.state == JobState::kRunning; });
  ASSERT_TRUE(store_->Cancel(id).ok());
  EXPECT_EQ(WaitForEnd(id).state, JobState::kCancelled);
}

TEST_F(JobRunnerTest, StopLetsAJobFinishWithinTheDrainTime) {
  std::atomic<bool> started{false};
  Start([&](const Job&, const RunContext&) -> Result<Json> {
    started = true;
    std::this_thread::sleep_for(milliseconds(50));
    return Json(1);
  });
  const std::string id = Submit();
  WaitFor(id, [&](const Job&) { return started.load(); });
  const std::string waiting = store_->Submit({.kind = "other"}).value().id;
  runner_->Stop(60'000);
  EXPECT_EQ(store_->Get(id).value().state, JobState::kSucceeded);
  EXPECT_EQ(store_->Get(waiting).value().state, JobState::kQueued);
}

TEST_F(JobRunnerTest, StopGivesBackWhatDoesNotFinish) {
  Start(WorkUntilStopped);
  const std::string id = Submit();
  WaitFor(id, [](const Job& job) { return job.state == JobState::kRunning; });
  runner_->Stop(1);
  const Job job = store_->Get(id).value();
  EXPECT_EQ(job.state, JobState::kQueued);
  EXPECT_EQ(job.failures, 0);
  EXPECT_EQ(runner_->active(), 0);
}

TEST_F(JobRunnerTest, TellsTheHandlerThatItsLeaseIsLost) {
  std::atomic<int> told{0};
  Start([&](const Job& job, const RunContext& context) -> Result<Json> {
    if (job.attempt > 1) return Json("second");
    const Result<Json> stopped = WorkUntilStopped(job, context);
    ++told;
    return stopped;
  });
  const std::string id = Submit();
  const Job first = WaitFor(id, [](const Job& job) { return job.state == JobState::kRunning; });
  ASSERT_TRUE(store_->Release(id, first.attempt).ok());
  EXPECT_EQ(WaitForEnd(id).result, Json("second"));
  EXPECT_EQ(told, 1);
}

TEST_F(JobRunnerTest, ReportsAttemptsToTheObserver) {
  std::atomic<int> observed{0};
  JobRunnerOptions options;
  options.on_attempt = [&](const Job&, const Status& outcome, double) { observed += outcome.ok() ? 1 : 100; };
  Start([](const Job&, const RunContext&) -> Result<Json> { return Json(1); }, {}, options);
  WaitForEnd(Submit());
  runner_->Stop();
  EXPECT_EQ(observed, 1);
}

TEST(JobRunnerOptionsTest, AreChecked) {
  EXPECT_TRUE(JobRunnerOptions{}.Check().ok());
  EXPECT_EQ((JobRunnerOptions{.workers = 0}).Check().field(), "workers");
  EXPECT_EQ((JobRunnerOptions{.lease_ms = 1'000, .heartbeat_ms = 500}).Check().field(), "lease_ms");
}

}  // namespace
}  // namespace drupe
