#include "reconstruction/part_jobs.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/ids.h"
#include "jobs/sql/sql_job_store.h"
#include "jobs/sqlite/database.h"
#include "store/disk_object_store.h"

namespace drupe {
namespace {

using Results = std::vector<std::string>;

class PartJobsTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(directory_);
    database_ = SqliteDatabase::Open(directory_ / "jobs.db").value();
    objects_ = DiskObjectStore::Open(directory_ / "objects").value();
    jobs_ = OpenJobStore(*database_, {.first_backoff_ms = 1, .max_backoff_ms = 1}).value();
    parent_ = jobs_->Submit({.kind = "reconstruct", .payload = {{"images", 3}}}).value();
  }
  void TearDown() override {
    jobs_.reset();
    objects_.reset();
    database_.reset();
    std::filesystem::remove_all(directory_);
  }

  /// Runs the parts "a", "b" and "c"; calls `meanwhile` before the first that is done here, and counts those.
  Result<Results> Run(const std::function<void()>& meanwhile = {}, const RunContext& context = {}) {
    StageParts parts;
    parts.parts = {"a", "b", "c"};
    parts.here = [&](std::size_t number) -> Result<std::string> {
      const std::string& part = parts.parts[number];
      if (here_.empty() && meanwhile) meanwhile();
      here_ += part;
      return part + " here";
    };
    parts.done = [&](std::size_t part) { done_ += static_cast<char>('a' + part); };
    return PartJobs(*jobs_, *objects_, parent_, context).Run(parts);
  }
  /// What another worker does: takes the first part that waits.
  Job Claim(std::int64_t lease_ms = 60'000) { return jobs_->Claim({kPartKind}, "other", lease_ms).value().value(); }
  void Complete(const Job& job) {
    const std::string part = objects_->Get(job.payload["part"].get<std::string>()).value();
    const ObjectInfo stored = objects_->Put(part + " there").value();
    ASSERT_TRUE(jobs_->Complete(job.id, job.attempt, {{"sha256", stored.sha256}}).ok());
  }
  std::vector<Job> Parts() { return jobs_->List({kPartKind, parent_.id, std::nullopt}, 100, "").value().jobs; }

  const std::filesystem::path directory_ = std::filesystem::temp_directory_path() / NewId("test");
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<DiskObjectStore> objects_;
  std::unique_ptr<JobStore> jobs_;
  Job parent_;
  std::string here_, done_;
};

TEST_F(PartJobsTest, DoesAllItselfWhenNobodyComes) {
  EXPECT_EQ(Run().value(), (Results{"a here", "b here", "c here"}));
  EXPECT_EQ(here_, "cba");
  EXPECT_EQ(done_, "cba");
  for (const Job& job : Parts()) EXPECT_EQ(job.state, JobState::kCancelled);
}

TEST_F(PartJobsTest, TakesWhatAnotherWorkerHasDone) {
  EXPECT_EQ(Run([&] { Complete(Claim()); }).value(), (Results{"a there", "b here", "c here"}));
  EXPECT_EQ(here_, "cb");
  EXPECT_EQ(done_, "cba");
}

TEST_F(PartJobsTest, LeavesItsWholeRequestWithEachPart) {
  Job claimed;
  ASSERT_TRUE(Run([&] { Complete(claimed = Claim()); }).ok());
  EXPECT_EQ(claimed.payload["reconstruct"], parent_.payload);
  EXPECT_EQ(claimed.subject, parent_.id);
  EXPECT_GT(claimed.priority, parent_.priority);
}

TEST_F(PartJobsTest, DoesThePartOfAWorkerThatDies) {
  EXPECT_EQ(Run([&] { Claim(1); }).value(), (Results{"a here", "b here", "c here"}));
  EXPECT_EQ(here_, "cba");
}

TEST_F(PartJobsTest, DoesThePartThatAnotherWorkerCannot) {
  const auto fail = [&] {
    const Job job = Claim();
    ASSERT_TRUE(jobs_->Fail(job.id, job.attempt, {"bad_part", "no", ""}, false).ok());
  };
  EXPECT_EQ(Run(fail).value(), (Results{"a here", "b here", "c here"}));
}

TEST_F(PartJobsTest, DoesThePartWhoseResultIsGone) {
  const auto lose = [&] {
    Complete(Claim());
    ASSERT_TRUE(objects_->Remove(Parts().back().result->at("sha256").get<std::string>()).ok());
  };
  EXPECT_EQ(Run(lose).value(), (Results{"a here", "b here", "c here"}));
}

TEST_F(PartJobsTest, FindsAgainWhatItsLastAttemptGotDone) {
  RunContext killed;
  bool stop = false;
  killed.cancelled = [&] { return stop; };
  const auto die = [&] {
    Complete(Claim());
    stop = true;
  };
  EXPECT_EQ(Run(die, killed).status().code(), "cancelled");
  here_.clear();
  EXPECT_EQ(Run().value(), (Results{"a there", "b here", "c here"}));
  EXPECT_EQ(here_, "cb");
}

TEST_F(PartJobsTest, WithdrawsItsPartsWhenItIsCancelled) {
  RunContext context;
  bool stop = false;
  context.cancelled = [&] { return stop; };
  const auto cancel = [&] {
    Claim();
    stop = true;
  };
  EXPECT_EQ(Run(cancel, context).status().code(), "cancelled");
  const std::vector<Job> parts = Parts();
  ASSERT_EQ(parts.size(), 3u);
  for (const Job& job : parts) EXPECT_TRUE(job.state == JobState::kCancelled || job.cancel_requested);
}

TEST_F(PartJobsTest, DoesWhatTheQueueHasNoPlaceFor) {
  jobs_ = OpenJobStore(*database_, {.max_queued = 2}).value();
  EXPECT_EQ(Run().value(), (Results{"a here", "b here", "c here"}));
  EXPECT_EQ(Parts().size(), 1u);
}

}  // namespace
}  // namespace drupe
