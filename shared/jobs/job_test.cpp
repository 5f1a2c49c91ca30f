#include "jobs/job.h"

#include <gtest/gtest.h>

#include <thread>

#include "jobs/change_signal.h"
#include "jobs/job_store.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

TEST(JobTest, StateNamesReadBack) {
  for (const JobState state :
       {JobState::kQueued, JobState::kRunning, JobState::kSucceeded, JobState::kFailed, JobState::kCancelled}) {
    EXPECT_EQ(ParseJobState(JobStateName(state)).value(), state);
  }
  EXPECT_EQ(ParseJobState("dead").status().code(), "invalid_state");
}

TEST(JobStoreOptionsTest, BackoffDoublesUpToItsMaximum) {
  const JobStoreOptions options{.first_backoff_ms = 1'000, .max_backoff_ms = 60'000};
  EXPECT_EQ(options.BackoffMs(1), 1'000);
  EXPECT_EQ(options.BackoffMs(2), 2'000);
  EXPECT_EQ(options.BackoffMs(6), 32'000);
  EXPECT_EQ(options.BackoffMs(7), 60'000);
  EXPECT_EQ(options.BackoffMs(100), 60'000);
  EXPECT_EQ((JobStoreOptions{.first_backoff_ms = 0}).BackoffMs(5), 0);
}

TEST(ChangeSignalTest, WaitsForAChangeAfterTheVersionSeen) {
  ChangeSignal signal;
  const std::uint64_t seen = signal.version();
  EXPECT_EQ(signal.WaitBeyond(seen, milliseconds(1)), seen);
  signal.Notify();
  EXPECT_EQ(signal.WaitBeyond(seen, milliseconds(60'000)), seen + 1);
  std::thread notifier([&] { signal.Notify(); });
  EXPECT_EQ(signal.WaitBeyond(seen + 1, milliseconds(60'000)), seen + 2);
  notifier.join();
}

}  // namespace
}  // namespace drupe
