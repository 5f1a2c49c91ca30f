#include <gtest/gtest.h>
#include <libpq-fe.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <mutex>
#include <set>
#include <thread>

#include "base/ids.h"
#include "jobs/job_store_conformance.h"
#include "jobs/postgres/postgres_database.h"
#include "jobs/postgres/temporary_postgres.h"
#include "jobs/sql/sql_job_store.h"

namespace drupe {

namespace {

using std::chrono::milliseconds;

std::unique_ptr<Database> OpenSchema(const std::string& schema) {
  return OpenPostgresDatabase(TemporaryPostgres::Get().url(), schema).value();
}

class PostgresUnderTest : public JobStoreUnderTest {
 public:
  explicit PostgresUnderTest(const JobStoreOptions& options)
      : database_(OpenSchema(NewId("t"))), store_(OpenJobStore(*database_, options, clock_).value()) {}
  JobStore& store() override { return *store_; }

 private:
  std::unique_ptr<Database> database_;
  std::unique_ptr<JobStore> store_;
};

}  // namespace

std::unique_ptr<JobStoreUnderTest> MakeJobStoreUnderTest(const JobStoreOptions& options) {
  if (TemporaryPostgres::Get().url().empty()) return nullptr;
  return std::make_unique<PostgresUnderTest>(options);
}

std::string WhyNoJobStoreUnderTest() {
  return TemporaryPostgres::Get().reason();
}

namespace {

/// A store as one process has it.
struct Process {
  explicit Process(const std::string& schema)
      : database(OpenSchema(schema)), store(OpenJobStore(*database, {}).value()) {}

  Job Claim() { return store->Claim({"work"}, "w", 60'000).value().value_or(Job{}); }

  std::unique_ptr<Database> database;
  std::unique_ptr<JobStore> store;
};

class PostgresJobStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    if (TemporaryPostgres::Get().url().empty()) GTEST_SKIP() << TemporaryPostgres::Get().reason();
  }
  /// Ends all connections of the schema's stores on the server's side.
  static void CutConnections() {
    PGconn* const admin = PQconnectdb(TemporaryPostgres::Get().url().c_str());
    PQclear(PQexec(admin, "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE application_name = 'drupe'"));
    PQfinish(admin);
  }

  const std::string schema_ = NewId("t");
};

TEST_F(PostgresJobStoreTest, ProcessesClaimEveryJobOnce) {
  constexpr int kJobs = 100;
  Process api(schema_);
  for (int i = 0; i < kJobs; ++i) ASSERT_TRUE(api.store->Submit({.kind = "work"}).ok());
  std::mutex mutex;
  std::multiset<std::string> claimed;
  std::vector<std::thread> workers;
  for (int i = 0; i < 4; ++i) {
    workers.emplace_back([&] {
      Process worker(schema_);
      while (const auto job = worker.store->Claim({"work"}, "w", 60'000).value()) {
        ASSERT_TRUE(worker.store->Complete(job->id, job->attempt, {}).ok());
        const std::lock_guard lock(mutex);
        claimed.insert(job->id);
      }
    });
  }
  for (std::thread& worker : workers) worker.join();
  EXPECT_EQ(claimed.size(), static_cast<std::size_t>(kJobs));
  EXPECT_EQ(std::set<std::string>(claimed.begin(), claimed.end()).size(), claimed.size());
  EXPECT_EQ(api.store->Counts()->succeeded, kJobs);
}

TEST_F(PostgresJobStoreTest, ProcessesThatSubmitOneKeyGetOneJob) {
  std::vector<std::thread> clients;
  std::mutex mutex;
  std::set<std::string> ids;
  for (int i = 0; i < 8; ++i) {
    clients.emplace_back([&] {
      Process client(schema_);
      const std::string id = client.store->Submit({.kind = "work", .idempotency_key = "key"}).value().id;
      const std::lock_guard lock(mutex);
      ids.insert(id);
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(ids.size(), 1u);
  EXPECT_EQ(Process(schema_).store->Counts()->queued, 1);
}

TEST_F(PostgresJobStoreTest, ChangeOfOneProcessWakesTheOthers) {
  Process api(schema_);
  Process worker(schema_);
  const std::uint64_t seen = worker.store->changes().version();
  ASSERT_TRUE(api.store->Submit({.kind = "work"}).ok());
  EXPECT_GT(worker.store->changes().WaitBeyond(seen, milliseconds(5'000)), seen);
}

TEST_F(PostgresJobStoreTest, CancelReachesTheWorkerOfAnotherProcess) {
  Process api(schema_);
  Process worker(schema_);
  const std::string id = api.store->Submit({.kind = "work"}).value().id;
  const Job job = worker.Claim();
  ASSERT_TRUE(api.store->Cancel(id).ok());
  EXPECT_TRUE(worker.store->Beat(id, job.attempt, {"dense", 0.5, 60'000}).value());
  ASSERT_TRUE(worker.store->MarkCancelled(id, job.attempt).ok());
  EXPECT_EQ(api.store->Get(id)->state, JobState::kCancelled);
}

TEST_F(PostgresJobStoreTest, OpeningLeavesTheJobsOfLivingWorkersAlone) {
  Process worker(schema_);
  ASSERT_TRUE(worker.store->Submit({.kind = "work"}).ok());
  const Job job = worker.Claim();
  Process other(schema_);
  EXPECT_EQ(other.store->Get(job.id)->state, JobState::kRunning);
  EXPECT_TRUE(worker.store->Complete(job.id, job.attempt, {}).ok());
}

TEST_F(PostgresJobStoreTest, LostConnectionsAreOpenedAgain) {
  Process process(schema_);
  const std::string id = process.store->Submit({.kind = "work"}).value().id;
  CutConnections();
  EXPECT_EQ(process.Claim().id, id);
  const std::uint64_t seen = process.store->changes().version();
  ASSERT_TRUE(Process(schema_).store->Submit({.kind = "work"}).ok());
  EXPECT_GT(process.store->changes().WaitBeyond(seen, milliseconds(10'000)), seen) << "the listener is back too";
}

TEST_F(PostgresJobStoreTest, KilledProcessLeavesNoHalfTransaction) {
  Process api(schema_);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(api.store->Submit({.kind = "work"}).ok());
  const pid_t child = ::fork();
  if (child == 0) {
    Process worker(schema_);
    for (;;) {
      const Job job = worker.Claim();
      (void)worker.store->Release(job.id, job.attempt);
    }
  }
  std::this_thread::sleep_for(milliseconds(300));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  for (int i = 0; i < 19; ++i) {
    const Job job = api.Claim();
    ASSERT_TRUE(api.store->Complete(job.id, job.attempt, {}).ok()) << i;
  }
}

TEST_F(PostgresJobStoreTest, ServerGivesUpTheTransactionOfAFrozenProcessWithinSeconds) {
  Process process(schema_);
  std::string patience;
  const auto show = [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto row, process.database->Prepare("SHOW idle_in_transaction_session_timeout"));
    DRUPE_ASSIGN_OR_RETURN(const bool found, row->Step());
    if (found) patience = row->Text(0);
    return Status::Ok();
  };
  ASSERT_TRUE(process.database->Transaction(Durability::kProcessDeath, show).ok());
  EXPECT_EQ(patience, "5s");
}

TEST_F(PostgresJobStoreTest, ManyProcessesMayCreateTheTablesAtOnce) {
  std::vector<std::thread> starting;
  for (int i = 0; i < 6; ++i) {
    starting.emplace_back([&] { EXPECT_TRUE(Process(schema_).store->Counts().ok()); });
  }
  for (std::thread& process : starting) process.join();
}

TEST_F(PostgresJobStoreTest, UnreachableServerIsSaidSo) {
  const auto database = OpenPostgresDatabase("postgres:///postgres?host=/nonexistent", "t");
  EXPECT_EQ(database.status().code(), "database_unreachable");
  EXPECT_EQ(database.status().kind(), StatusKind::kUnavailable);
  EXPECT_EQ(OpenPostgresDatabase("postgres://", "T; DROP").status().code(), "invalid_jobs_url");
}

TEST_F(PostgresJobStoreTest, ClaimsFiveHundredJobsASecond) {
  constexpr int kJobs = 200;
  Process process(schema_);
  for (int i = 0; i < kJobs; ++i) ASSERT_TRUE(process.store->Submit({.kind = "work"}).ok());
  const Stopwatch watch;
  for (int i = 0; i < kJobs; ++i) ASSERT_NE(process.Claim().id, "");
  RecordProperty("claims_per_second", static_cast<int>(kJobs / watch.WallSeconds()));
  // This process's CPU alone, so that a busy test machine does not fail it.
  EXPECT_LT(watch.CpuSeconds(), kJobs / 500.0);
}

}  // namespace
}  // namespace drupe
