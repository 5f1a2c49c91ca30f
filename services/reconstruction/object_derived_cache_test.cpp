#include "reconstruction/object_derived_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "base/ids.h"
#include "jobs/sqlite/database.h"
#include "store/disk_object_store.h"

namespace drupe {
namespace {

constexpr std::chrono::milliseconds kTick{3};  ///< more than the resolution of the time of use

class ObjectDerivedCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::temp_directory_path() / NewId("test");
    std::filesystem::create_directories(directory_);
    Open(1'000'000);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  void Open(std::int64_t max_bytes, std::chrono::milliseconds patience = ObjectDerivedCache::kPatience) {
    cache_.reset();
    database_.reset();
    objects_ = std::move(DiskObjectStore::Open(directory_ / "objects").value());
    database_ = std::move(SqliteDatabase::Open(directory_ / "test.db").value());
    cache_ = std::move(ObjectDerivedCache::Open(*database_, *objects_, max_bytes, patience).value());
  }

  /// What is under `key`, made from `text` when nothing is.
  std::string Ask(const std::string& key, const std::string& text) {
    return cache_->FindOrMake(key, [&]() -> Result<std::string> { return text; }, {}).value();
  }

  std::vector<std::filesystem::path> StoredObjects() const {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory_ / "objects")) {
      if (entry.is_regular_file() && entry.path().filename().string().size() >= 60) paths.push_back(entry.path());
    }
    return paths;
  }

  std::filesystem::path directory_;
  std::unique_ptr<ObjectStore> objects_;
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<ObjectDerivedCache> cache_;
};

TEST_F(ObjectDerivedCacheTest, MakesOnceAndRemembersOverARestart) {
  EXPECT_EQ(Ask("a", "first"), "first");
  EXPECT_EQ(Ask("a", "second"), "first");
  EXPECT_EQ(Ask("b", "second"), "second");
  EXPECT_EQ(cache_->hits(), 1);
  EXPECT_EQ(cache_->misses(), 2);
  Open(1'000'000);
  EXPECT_EQ(Ask("a", "third"), "first");
}

TEST_F(ObjectDerivedCacheTest, FindMakesNothing) {
  EXPECT_FALSE(cache_->Find("a"));
  EXPECT_EQ(cache_->misses(), 0);
  Ask("a", "first");
  EXPECT_EQ(cache_->Find("a"), "first");
  EXPECT_EQ(cache_->hits(), 1);
  EXPECT_EQ(cache_->misses(), 1);
}

TEST_F(ObjectDerivedCacheTest, EqualBytesOfTwoKeysAreTwoObjects) {
  Ask("a", "same");
  Ask("b", "same");
  EXPECT_EQ(StoredObjects().size(), 2u);
}

TEST_F(ObjectDerivedCacheTest, FailureIsPassedOnAndNotKept) {
  const auto fail = []() -> Result<std::string> { return Unprocessable("bad_image", "no picture"); };
  EXPECT_EQ(cache_->FindOrMake("a", fail, {}).status().code(), "bad_image");
  EXPECT_EQ(Ask("a", "now"), "now");
}

TEST_F(ObjectDerivedCacheTest, WhatIsMissingOrDamagedIsMadeAgain) {
  Ask("a", "1");
  std::filesystem::remove(StoredObjects().at(0));
  EXPECT_EQ(Ask("a", "2"), "2");
  std::filesystem::resize_file(StoredObjects().at(0), 5);
  EXPECT_EQ(Ask("a", "3"), "3");
  EXPECT_EQ(Ask("a", "4"), "3");
}

TEST_F(ObjectDerivedCacheTest, LongestUnusedGoesFirst) {
  Open(2'500);
  const std::string big(1'000, 'x');
  for (const std::string key : {"a", "b", "a", "c"}) {
    Ask(key, big + key);
    std::this_thread::sleep_for(kTick);
  }
  EXPECT_EQ(StoredObjects().size(), 2u);
  EXPECT_EQ(Ask("a", "again"), big + "a");
  EXPECT_EQ(Ask("c", "again"), big + "c");
  EXPECT_EQ(Ask("b", "again"), "again");
}

TEST_F(ObjectDerivedCacheTest, TooLargeIsNotKept) {
  Open(0);
  EXPECT_EQ(Ask("a", "1"), "1");
  EXPECT_EQ(Ask("a", "2"), "2");
  EXPECT_TRUE(StoredObjects().empty());
}

TEST_F(ObjectDerivedCacheTest, WhatTakesTooLongIsNotWaitedFor) {
  Open(1'000'000, 5 * kTick);
  std::promise<void> begun, may_end;
  std::thread slow([&] {
    const auto make = [&]() -> Result<std::string> {
      begun.set_value();
      may_end.get_future().wait();
      return std::string("slow");
    };
    EXPECT_EQ(cache_->FindOrMake("a", make, {}).value(), "slow");
  });
  begun.get_future().wait();
  EXPECT_EQ(Ask("a", "quick"), "quick");
  EXPECT_EQ(Ask("a", "again"), "quick");  // which the slow one still holds
  may_end.set_value();
  slow.join();
  EXPECT_EQ(cache_->misses(), 2);
  EXPECT_EQ(Ask("a", "again"), "slow");
  EXPECT_EQ(StoredObjects().size(), 1u);
}

TEST_F(ObjectDerivedCacheTest, ManyAtOnceShareTheWork) {
  std::atomic<int> made{0};
  const auto make = [&]() -> Result<std::string> {
    std::this_thread::sleep_for(5 * kTick);
    return std::to_string(++made);
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] { EXPECT_EQ(cache_->FindOrMake("a", make, {}).value(), "1"); });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(made, 1);
}

TEST_F(ObjectDerivedCacheTest, WaitingEndsWhenCancelled) {
  std::atomic<bool> begun{false}, is_over{false};
  const auto slow = [&]() -> Result<std::string> {
    begun = true;
    while (!is_over) std::this_thread::sleep_for(kTick);
    return std::string("done");
  };
  std::thread maker([&] { EXPECT_EQ(cache_->FindOrMake("a", slow, {}).value(), "done"); });
  while (!begun) std::this_thread::sleep_for(kTick);
  RunContext context;
  context.cancelled = [] { return true; };
  EXPECT_EQ(cache_->FindOrMake("a", slow, context).status().code(), "cancelled");
  is_over = true;
  maker.join();
}

TEST(DerivedKeyTest, DependsOnKindAndParameters) {
  const std::string key = DerivedKey("features", {{"picture", "p"}});
  EXPECT_EQ(key.size(), 64u);
  EXPECT_EQ(key, DerivedKey("features", {{"picture", "p"}}));
  EXPECT_NE(key, DerivedKey("board", {{"picture", "p"}}));
  EXPECT_NE(key, DerivedKey("features", {{"picture", "q"}}));
}

}  // namespace
}  // namespace drupe
