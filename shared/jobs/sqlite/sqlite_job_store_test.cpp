#include "jobs/sql/sql_job_store.h"
#include "jobs/sqlite/database.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "base/ids.h"
#include "jobs/job_store_conformance.h"

namespace drupe {

namespace {

namespace fs = std::filesystem;

class TemporaryDirectory {
 public:
  TemporaryDirectory() { fs::create_directories(path_); }
  ~TemporaryDirectory() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  const fs::path path_ = fs::temp_directory_path() / NewId("jobstest");
};

class SqliteUnderTest : public JobStoreUnderTest {
 public:
  explicit SqliteUnderTest(const JobStoreOptions& options)
      : database_(SqliteDatabase::Open(directory_.path() / "jobs.db").value()),
        store_(OpenJobStore(*database_, options, clock_).value()) {}
  JobStore& store() override { return *store_; }

 private:
  TemporaryDirectory directory_;
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<JobStore> store_;
};

}  // namespace

std::unique_ptr<JobStoreUnderTest> MakeJobStoreUnderTest(const JobStoreOptions& options) {
  return std::make_unique<SqliteUnderTest>(options);
}

std::string WhyNoJobStoreUnderTest() {
  return "";
}

namespace {

class SqliteJobStoreTest : public testing::Test {
 protected:
  /// Runs `body` on the store in a process of its own that is then killed without warning.
  template <typename Body>
  void RunAndKill(Body body) {
    const pid_t child = ::fork();
    if (child == 0) {
      Open();
      body(*store_);
      ::kill(::getpid(), SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
  }
  void Open() {
    store_.reset();
    database_.reset();
    database_ = SqliteDatabase::Open(directory_.path() / "jobs.db").value();
    store_ = OpenJobStore(*database_, {}, clock_).value();
  }

  FakeClock clock_;
  TemporaryDirectory directory_;
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<JobStore> store_;
};

TEST_F(SqliteJobStoreTest, KilledProcessFindsItsJobsAgainAndClaimsThemAtOnce) {
  RunAndKill([](JobStore& store) {
    (void)store.Submit({.kind = "work", .idempotency_key = "done"});
    const Job done = *store.Claim({"work"}, "w", 60'000).value();
    (void)store.Complete(done.id, done.attempt, {{"y", 2}});
    (void)store.Submit({.kind = "work", .idempotency_key = "interrupted"});
    (void)store.Submit({.kind = "work", .idempotency_key = "waiting"});
    (void)store.Claim({"work"}, "w", 60'000);
  });
  Open();
  EXPECT_EQ(store_->Submit({.kind = "work", .idempotency_key = "done"}).value().result, Json({{"y", 2}}));
  const Job again = *store_->Claim({"work"}, "w", 60'000).value();
  EXPECT_EQ(again.idempotency_key, "interrupted");
  EXPECT_EQ(again.attempt, 2);
  EXPECT_EQ(store_->Claim({"work"}, "w", 60'000).value()->idempotency_key, "waiting");
}

TEST_F(SqliteJobStoreTest, JobThatKillsItsProcessIsGivenUp) {
  for (int i = 0; i < 3; ++i) {
    RunAndKill([](JobStore& store) {
      (void)store.Submit({.kind = "work", .idempotency_key = "poison"});
      (void)store.Claim({"work"}, "w", 60'000);
    });
  }
  Open();
  EXPECT_FALSE(store_->Claim({"work"}, "w", 60'000).value());
  const Job poison = store_->Submit({.kind = "work", .idempotency_key = "poison"}).value();
  EXPECT_EQ(poison.state, JobState::kFailed);
  EXPECT_EQ(poison.error->code, "attempts_exhausted");
}

TEST_F(SqliteJobStoreTest, CancelOutlivesTheProcess) {
  RunAndKill([](JobStore& store) {
    const Job job = store.Submit({.kind = "work", .idempotency_key = "key"}).value();
    (void)store.Claim({"work"}, "w", 60'000);
    (void)store.Cancel(job.id);
  });
  Open();
  EXPECT_EQ(store_->Submit({.kind = "work", .idempotency_key = "key"}).value().state, JobState::kCancelled);
}

TEST_F(SqliteJobStoreTest, ClaimsAThousandJobsASecond) {
  Open();
  constexpr int kJobs = 200;
  for (int i = 0; i < kJobs; ++i) ASSERT_TRUE(store_->Submit({.kind = "work"}).ok());
  const Stopwatch watch;
  for (int i = 0; i < kJobs; ++i) ASSERT_TRUE(store_->Claim({"work"}, "w", 60'000).value());
  RecordProperty("claims_per_second", static_cast<int>(kJobs / watch.WallSeconds()));
  // CPU, so that a busy test machine does not fail it; claims wait for no fsync.
  EXPECT_LT(watch.CpuSeconds(), kJobs / 1'000.0);
}

}  // namespace
}  // namespace drupe
