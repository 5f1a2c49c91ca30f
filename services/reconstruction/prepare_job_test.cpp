#include "reconstruction/prepare_job.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/files.h"
#include "base/ids.h"
#include "base/json.h"
#include "jobs/sql/sql_job_store.h"
#include "jobs/sqlite/database.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/intake.h"
#include "reconstruction/memory_cache.h"
#include "reconstruction/reconstruct_request.h"
#include "store/disk_object_store.h"

namespace drupe {
namespace {

/// A set of pictures of the sample whose words are trained on two of them.
class PrepareJobTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(directory_);
    database_ = SqliteDatabase::Open(directory_ / "test.db").value();
    objects_ = DiskObjectStore::Open(directory_ / "objects").value();
    sets_ = ImageSetStore::Open(*database_, limits_).value();
    jobs_ = OpenJobStore(*database_, {}).value();
    const Json options = {{"features", {{"first_octave", 1}, {"max_features", 500}}},
                          {"similarity", {{"training_images", 2}}}};
    set_ = sets_->Create({{"options", options}}).value();
  }
  void TearDown() override {
    jobs_.reset();
    sets_.reset();
    objects_.reset();
    database_.reset();
    std::filesystem::remove_all(directory_);
  }

  /// A picture of the sample under another name, or its own.
  void Upload(const std::string& name, const std::string& picture) {
    const std::string bytes = ReadFile(std::string(DRUPE_TEST_DATA) + "/plum-s/images/" + picture).value();
    const StoredImage image = StoreImage(*objects_, name, bytes, limits_).value();
    ASSERT_TRUE(sets_->PutImage(set_.id, image).ok());
    ASSERT_TRUE(LeavePreparation(*jobs_, AnnouncedRequest(set_).value(), image).ok());
  }
  /// Does the job that is next; gives its result.
  template <typename Handler>
  Json Do(const Handler& handler, const Job& job) {
    Json result;
    std::thread worker([&] { result = handler(job, {}).value(); });
    worker.join();  // which alone has lowered its priority
    EXPECT_TRUE(jobs_->Complete(job.id, job.attempt, result).ok());
    return result;
  }
  Json Prepare() {
    return Do(PrepareJob(ArrivalStores{*objects_, *sets_, cache_, limits_}),
              jobs_->Claim({kPrepareKind}, "test", 60'000).value().value());
  }

  const std::filesystem::path directory_ = std::filesystem::temp_directory_path() / NewId("test");
  const Limits limits_;
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<DiskObjectStore> objects_;
  std::unique_ptr<ImageSetStore> sets_;
  std::unique_ptr<JobStore> jobs_;
  MemoryCache cache_;
  ImageSet set_;
};

using Names = std::vector<std::string>;

TEST_F(PrepareJobTest, TellsFeaturesAndTheMostSimilarPicturesThatCameBefore) {
  Upload("00.jpg", "00.jpg");
  const Json first = Prepare();
  Upload("01.jpg", "05.jpg");
  const Json second = Prepare();
  Upload("02.jpg", "05.jpg");
  const Json third = Prepare();
  EXPECT_GT(first["features"], 100);
  EXPECT_EQ(first["candidates"], Names());
  EXPECT_EQ(second["candidates"], Names({"00.jpg"}));
  EXPECT_EQ(third["candidates"], Names({"01.jpg", "00.jpg"}));
}

TEST_F(PrepareJobTest, PicturesAreMatchedOnceNoneWaitsToBePrepared) {
  constexpr int kPictures = 13;
  const std::string calibration = ReadFile(std::string(DRUPE_TEST_DATA) + "/plum-s/calibration.json").value();
  set_ =
      sets_->Create({{"options", set_.announced["options"]}, {"calibration", ParseJson(calibration).value()}}).value();
  std::vector<std::string> names;
  for (int i = 0; i < kPictures; ++i) {
    names.push_back((i < 10 ? "0" : "") + std::to_string(i) + ".jpg");
    Upload(names.back(), names.back());
  }
  const auto next = [&] { return jobs_->Claim({kPrepareKind, kMatchKind}, "test", 60'000).value().value(); };
  for (int i = 0; i < kPictures; ++i) {
    const Job job = next();
    EXPECT_EQ(job.kind, kPrepareKind);
    Do(PrepareJob(ArrivalStores{*objects_, *sets_, cache_, limits_}), job);
  }
  std::vector<int> pairs;
  for (int i = 0; i < kPictures; ++i) {
    const Job job = next();
    EXPECT_EQ(job.kind, kMatchKind);
    pairs.push_back(Do(MatchJob(ArrivalStores{*objects_, *sets_, cache_, limits_}), job)["pairs"]);
  }
  EXPECT_EQ(pairs[10], 0);  // inside the front
  EXPECT_GE(pairs[11], 3);
  EXPECT_GE(pairs[12], 5);
  EXPECT_FALSE(jobs_->Claim({kPrepareKind, kMatchKind}, "test", 60'000).value().has_value());
}

TEST_F(PrepareJobTest, WhatIsDoneIsToldOfTheSetsPictures) {
  Upload("00.jpg", "00.jpg");
  Upload("01.jpg", "05.jpg");
  const Json first = Prepare();
  EXPECT_EQ(PreparationsOf(sets_->Get(set_.id).value(), *jobs_).value(),
            (std::vector<std::optional<Json>>{first, std::nullopt}));
  const Json second = Prepare();
  EXPECT_EQ(PreparationsOf(sets_->Get(set_.id).value(), *jobs_).value(),
            (std::vector<std::optional<Json>>{first, second}));
  Upload("00.jpg", "10.jpg");  // another picture of that name
  EXPECT_EQ(PreparationsOf(sets_->Get(set_.id).value(), *jobs_).value(),
            (std::vector<std::optional<Json>>{std::nullopt, second}));
}

TEST_F(PrepareJobTest, WhatCannotBeComparedIsPreparedAllTheSame) {
  Upload("00.jpg", "00.jpg");
  Upload("01.jpg", "05.jpg");
  Prepare();
  ASSERT_TRUE(sets_->PutImage(set_.id, {"00.jpg", std::string(64, '0'), 3, 1280, 720}).ok());  // of which no object is
  const Json result = Prepare();
  EXPECT_GT(result["features"], 100);
  EXPECT_EQ(result["candidates"], Names());
}

TEST_F(PrepareJobTest, ASetThatWasForgottenIsNoError) {
  Upload("00.jpg", "00.jpg");
  ASSERT_TRUE(database_
                  ->Transaction(Durability::kProcessDeath,
                                [&]() -> Status {
                                  for (const std::string table : {"image_set_images", "image_sets"}) {
                                    DRUPE_ASSIGN_OR_RETURN(const auto remove,
                                                           database_->Prepare("DELETE FROM " + table));
                                    DRUPE_RETURN_IF_ERROR(remove->Run());
                                  }
                                  return Status::Ok();
                                })
                  .ok());
  EXPECT_GT(Prepare()["features"], 100);
}

}  // namespace
}  // namespace drupe
