#include "store/store_audit.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "base/digest.h"
#include "base/ids.h"
#include "store/object_store.h"

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
  std::unique_ptr<ObjectStore> store_ = ObjectStore::Open(directory_).value();
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

TEST(FindDigests, TakesRunsOfExactlySixtyFourDigits) {
  const std::string digest = Sha256Hex("x");
  std::vector<std::string> found;
  const auto collect = [&](std::string one) { found.push_back(std::move(one)); };
  FindDigests("{\"a\":\"" + digest + "\"} " + digest + "0 " + digest.substr(1) + " " + digest, collect);
  EXPECT_EQ(found, (std::vector<std::string>{digest, digest}));
}

}  // namespace
}  // namespace drupe
