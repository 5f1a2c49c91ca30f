#include "store/store_audit.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <limits>

#include "base/digest.h"
#include "base/ids.h"
#include "store/disk_object_store.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kFuture = std::numeric_limits<std::int64_t>::max();

class StoreAuditTest : public testing::Test {
 protected:
  ~StoreAuditTest() override { fs::remove_all(directory_); }

  std::string Put(const std::string& text) { return store_->Put(text).value().sha256; }
  fs::path PathOf(const std::string& digest) const { return directory_ / digest.substr(0, 2) / digest; }
  void Damage(const std::string& digest) { std::ofstream(PathOf(digest)) << "other bytes"; }

  const fs::path directory_ = fs::temp_directory_path() / NewId("audit");
  std::unique_ptr<DiskObjectStore> store_ = DiskObjectStore::Open(directory_).value();
};

TEST_F(StoreAuditTest, FindsDamagedAndMisnamedFiles) {
  const std::string good = Put("good"), bad = Put("bad");
  Damage(bad);
  std::ofstream(directory_ / "00" / "stray") << "x";
  const StoreAudit audit = CheckObjects(directory_).value();
  EXPECT_EQ(audit.objects, 1);
  EXPECT_EQ(audit.bytes, 4u);
  EXPECT_EQ(audit.damaged, std::vector<std::string>{bad});
  EXPECT_EQ(audit.misnamed, std::vector<std::string>{"00/stray"});
}

TEST_F(StoreAuditTest, WhatIsSetAsideIsGoneUntilItIsStoredAgain) {
  const std::string bad = Put("bad");
  Damage(bad);
  ASSERT_TRUE(SetAside(directory_, {bad}).ok());
  EXPECT_EQ(store_->Get(bad).status().code(), "object_not_found");
  EXPECT_TRUE(fs::exists(directory_ / "damaged" / bad));
  EXPECT_TRUE(CheckObjects(directory_)->damaged.empty());
  EXPECT_EQ(Put("bad"), bad);
  EXPECT_EQ(store_->Get(bad).value(), "bad");
}

TEST_F(StoreAuditTest, CollectsWhatNothingRefersTo) {
  const std::string leaf = Put("leaf"), garbage = Put("garbage");
  const std::string manifest = Put(R"({"leaf": ")" + leaf + R"("})");
  const GarbageReport report = CollectGarbage(directory_, {manifest}, {.unused_since_ns = kFuture}).value();
  EXPECT_EQ(report.kept, 2);
  EXPECT_EQ(report.removed, 1);
  EXPECT_EQ(report.removed_bytes, 7u);
  EXPECT_FALSE(store_->Contains(garbage));
  EXPECT_TRUE(store_->Contains(leaf)) << "reached through the manifest";
}

TEST_F(StoreAuditTest, YoungObjectsStayAndADryRunRemovesNothing) {
  const std::string young = Put("young");
  EXPECT_EQ(CollectGarbage(directory_, {}, {.unused_since_ns = 0})->removed, 0);
  EXPECT_EQ(CollectGarbage(directory_, {}, {.unused_since_ns = kFuture, .dry_run = true})->removed, 1);
  EXPECT_TRUE(store_->Contains(young));
}

/// Stores an object again in the moment between the collector's list and its removal.
class RestoringFileSystem : public FileSystem {
 public:
  explicit RestoringFileSystem(std::function<void()> restore) : restore_(std::move(restore)) {}

  Result<std::unique_ptr<PathLock>> Lock(const fs::path& path, bool alone) override {
    if (alone) std::exchange(restore_, [] {})();
    return posix_.Lock(path, alone);
  }
  Result<std::unique_ptr<WritableFile>> Create(const fs::path& path) override { return posix_.Create(path); }
  Result<std::unique_ptr<WritableFile>> OpenToAppend(const fs::path& path) override {
    return posix_.OpenToAppend(path);
  }
  Result<std::unique_ptr<ReadableFile>> Open(const fs::path& path) override { return posix_.Open(path); }
  Status CreateDirectory(const fs::path& path) override { return posix_.CreateDirectory(path); }
  Status Rename(const fs::path& from, const fs::path& to) override { return posix_.Rename(from, to); }
  Status Remove(const fs::path& path) override { return posix_.Remove(path); }
  Result<bool> RemoveIfAbandoned(const fs::path& path) override { return posix_.RemoveIfAbandoned(path); }
  Status Touch(const fs::path& path) override { return posix_.Touch(path); }
  Status SyncDirectory(const fs::path& path) override { return posix_.SyncDirectory(path); }
  Result<std::vector<std::string>> List(const fs::path& path) override { return posix_.List(path); }
  Result<std::uint64_t> FreeBytes(const fs::path& path) override { return posix_.FreeBytes(path); }

 private:
  FileSystem& posix_ = FileSystem::Posix();
  std::function<void()> restore_;
};

TEST_F(StoreAuditTest, AnObjectThatIsStoredAgainMeanwhileStays) {
  const std::string again = Put("again"), renewed = Put("renewed"), garbage = Put("garbage");
  const auto yesterday = fs::file_time_type::clock::now() - std::chrono::hours(24);
  for (const std::string& digest : {again, renewed, garbage}) fs::last_write_time(PathOf(digest), yesterday);
  RestoringFileSystem files([&] {
    Put("again");
    EXPECT_TRUE(store_->Renew(renewed).value());
  });
  const GarbageReport report = CollectGarbage(directory_, {}, {.unused_since_ns = kFuture}, files).value();
  EXPECT_EQ(report.removed, 1);
  EXPECT_EQ(store_->Get(again).value(), "again");
  EXPECT_TRUE(store_->Contains(renewed));
  EXPECT_FALSE(store_->Renew(garbage).value());
}

TEST(FindDigests, TakesRunsOfExactlySixtyFourDigits) {
  const std::string digest = Sha256Hex("x");
  std::vector<std::string> found;
  const auto collect = [&](std::string one) { found.push_back(std::move(one)); };
  FindDigests("{\"a\":\"" + digest + "\"} " + digest + "0 " + digest.substr(1) + " " + digest, collect);
  EXPECT_EQ(found, (std::vector<std::string>{digest, digest}));
}

}  // namespace
}  // namespace drupe
