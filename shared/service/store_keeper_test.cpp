#include "service/store_keeper.h"

#include <gtest/gtest.h>

#include "base/digest.h"
#include "base/ids.h"
#include "store/object_roots.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

class StoreKeeperTest : public testing::Test {
 protected:
  StoreKeeperTest() {
    options_.data = fs::temp_directory_path() / NewId("keeper");
    fs::create_directories(options_.data);
    stores_ = OpenServiceStores(options_, "test").value();
  }
  ~StoreKeeperTest() override { fs::remove_all(options_.data); }

  /// An object that looks `hours` old.
  std::string Put(const std::string& text, int hours) {
    const std::string sha256 = stores_.objects->Put(text).value().sha256;
    fs::last_write_time(options_.data / "objects" / sha256.substr(0, 2) / sha256,
                        fs::file_time_type::clock::now() - std::chrono::hours(hours));
    return sha256;
  }
  std::string EndedJob(const std::string& kind, const std::string& digest) {
    (void)stores_.jobs->Submit({.kind = kind, .payload = {{"sha256", digest}}});
    const Job job = *stores_.jobs->Claim({kind}, "w", 1000).value();
    EXPECT_TRUE(stores_.jobs->Complete(job.id, job.attempt, {}).ok());
    return job.id;
  }
  void SaidHoursAgo(const std::string& owner, int hours) {
    fs::last_write_time(options_.data / "objects" / "roots" / owner,
                        fs::file_time_type::clock::now() - std::chrono::hours(hours));
  }
  bool Has(const std::string& digest) { return stores_.objects->Contains(digest); }

  ServiceOptions options_;
  ServiceStores stores_;
  const std::int64_t hour_ms_ = 3'600'000;
};

TEST_F(StoreKeeperTest, RemovesOldObjectsThatNoServiceRefersTo) {
  const std::string garbage = Put("garbage", 30), young = Put("young", 20);
  const std::string mine = Put("mine", 30), others = Put("others", 30);
  EndedJob("work", mine);
  ASSERT_TRUE(stores_.objects->KeepRoots("other", {others}).ok());
  StoreKeeper keeper(stores_, {.owner = "test", .gc_interval_ms = 1, .gc_min_age_ms = 24 * hour_ms_});
  ASSERT_TRUE(keeper.KeepOnce().ok());
  EXPECT_FALSE(Has(garbage));
  EXPECT_TRUE(Has(young) && Has(mine) && Has(others));
}

TEST_F(StoreKeeperTest, TouchesNothingThatAServiceMayReferToSinceItSpoke) {
  const std::string since = Put("since", 30), before = Put("before", 100);
  ASSERT_TRUE(stores_.objects->KeepRoots("silent", {}).ok());
  SaidHoursAgo("silent", 48);
  StoreKeeper keeper(stores_, {.owner = "test", .gc_interval_ms = 1, .gc_min_age_ms = 24 * hour_ms_});
  ASSERT_TRUE(keeper.KeepOnce().ok());
  EXPECT_TRUE(Has(since)) << "it may have been referred to 30 hours ago";
  EXPECT_FALSE(Has(before));
}

TEST_F(StoreKeeperTest, ForgetsOldJobsOfItsKindsAndThenTheirObjects) {
  const std::string picture = Put("picture", 30), model = Put("model", 30);
  const std::string old = EndedJob("work", picture), kept = EndedJob("train", model);
  std::this_thread::sleep_for(
      std::chrono::milliseconds(3));  // so that the jobs ended before the millisecond of the look
  std::int64_t told = 0;
  StoreKeeper keeper(stores_, {.owner = "test", .kinds = {"work"}, .retain_ms = 1, .gc_interval_ms = 1},
                     [&](std::int64_t before_ms) {
                       told = before_ms;
                       return Status::Ok();
                     });
  ASSERT_TRUE(keeper.KeepOnce().ok());
  EXPECT_EQ(stores_.jobs->Get(old).status().code(), "job_not_found");
  EXPECT_TRUE(stores_.jobs->Get(kept).ok());
  EXPECT_FALSE(Has(picture));
  EXPECT_TRUE(Has(model));
  EXPECT_GT(told, 0);
}

TEST_F(StoreKeeperTest, WithoutOptionsOnlySaysWhatItRefersTo) {
  const std::string garbage = Put("garbage", 1000), mine = Put("mine", 1000);
  EndedJob("work", mine);
  StoreKeeper keeper(stores_, KeeperOptions(options_, "test", {"work"}));
  ASSERT_TRUE(keeper.KeepOnce().ok());
  EXPECT_TRUE(Has(garbage));
  EXPECT_EQ(ReadRoots(options_.data / "objects")->digests, std::set<std::string>{mine});
}

TEST_F(StoreKeeperTest, ADamagedListOfAServiceStopsTheCollection) {
  const std::string garbage = Put("garbage", 1000);
  ASSERT_TRUE(stores_.objects->KeepRoots("other", {}).ok());
  fs::resize_file(options_.data / "objects" / "roots" / "other", 10);
  StoreKeeper keeper(stores_, {.owner = "test", .gc_interval_ms = 1});
  EXPECT_EQ(keeper.KeepOnce().code(), "invalid_roots");
  EXPECT_TRUE(Has(garbage));
}

}  // namespace
}  // namespace drupe
