#include "store/object_upload.h"

#include <gtest/gtest.h>

#include "base/digest.h"
#include "base/ids.h"
#include "store/disk_object_store.h"
#include "store/simulated_file_system.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

std::span<const std::byte> Bytes(std::string_view text) {
  return std::as_bytes(std::span(text));
}

class ObjectUploadTest : public testing::Test {
 protected:
  ~ObjectUploadTest() override { fs::remove_all(directory_); }
  std::unique_ptr<DiskObjectStore> OpenStore() {
    return DiskObjectStore::Open(directory_, {.min_free_bytes = 0, .max_object_bytes = 1000}).value();
  }
  std::uint64_t Uploaded(const std::string& sha256) { return store_->UploadedBytes(sha256).value(); }

  const fs::path directory_ = fs::temp_directory_path() / NewId("upload");
  std::unique_ptr<DiskObjectStore> store_ = OpenStore();
  const std::string plum_ = Sha256Hex("plum");
};

TEST_F(ObjectUploadTest, GoesOnWhereItBrokeOffEvenAfterARestart) {
  EXPECT_EQ(Uploaded(plum_), 0u);
  {
    auto upload = store_->ResumeUpload(plum_, 0, 4).value();
    ASSERT_TRUE(upload.Append(Bytes("pl")).ok());
  }
  store_ = OpenStore();
  EXPECT_EQ(Uploaded(plum_), 2u);
  EXPECT_FALSE(store_->Contains(plum_)) << "not before all of it is here";
  auto upload = store_->ResumeUpload(plum_, 2, 4).value();
  ASSERT_TRUE(upload.Append(Bytes("um")).ok());
  EXPECT_TRUE(upload.complete());
  EXPECT_EQ(upload.Commit().value(), (ObjectInfo{plum_, 4}));
  EXPECT_EQ(store_->Get(plum_).value(), "plum");
  EXPECT_EQ(Uploaded(plum_), 0u);
}

TEST_F(ObjectUploadTest, RefusesAWrongDigestAndKeepsNothingOfIt) {
  auto upload = store_->ResumeUpload(plum_, 0, 4).value();
  ASSERT_TRUE(upload.Append(Bytes("pear")).ok());
  EXPECT_EQ(upload.Commit().status().code(), "digest_mismatch");
  EXPECT_FALSE(store_->Contains(plum_));
  EXPECT_EQ(Uploaded(plum_), 0u);
}

TEST_F(ObjectUploadTest, RefusesAGapAnOverlapASecondSenderAndTooMuch) {
  EXPECT_EQ(store_->ResumeUpload(plum_, 2, 4).status().code(), "upload_offset");
  auto upload = store_->ResumeUpload(plum_, 0, 4).value();
  ASSERT_TRUE(upload.Append(Bytes("pl")).ok());
  EXPECT_EQ(store_->ResumeUpload(plum_, 2, 4).status().code(), "upload_in_progress");
  EXPECT_EQ(upload.Append(Bytes("ums")).code(), "object_too_large");
  EXPECT_EQ(store_->ResumeUpload(Sha256Hex("long"), 0, 1001).status().code(), "object_too_large");
  EXPECT_EQ(store_->ResumeUpload("../../etc/passwd", 0, 1).status().code(), "invalid_digest");
  EXPECT_EQ(store_->UploadedBytes("../../etc/passwd").status().code(), "invalid_digest");
}

TEST_F(ObjectUploadTest, SweepsUploadsThatNobodyHasGoneOnWithForADay) {
  const std::string pear = Sha256Hex("pear");
  for (const std::string& sha256 : {plum_, pear}) {
    ASSERT_TRUE(store_->ResumeUpload(sha256, 0, 4).value().Append(Bytes("p")).ok());
  }
  fs::last_write_time(directory_ / "uploads" / plum_, fs::file_time_type::clock::now() - std::chrono::hours(25));
  store_ = OpenStore();
  EXPECT_EQ(Uploaded(plum_), 0u);
  EXPECT_EQ(Uploaded(pear), 1u);
}

/// Lists an upload that is gone when it is looked at, as when another process finishes it just then.
class LateListing : public SimulatedFileSystem {
 public:
  using SimulatedFileSystem::SimulatedFileSystem;
  Result<std::vector<std::string>> List(const std::filesystem::path& path) override {
    auto names = SimulatedFileSystem::List(path);
    if (path.filename() == "uploads") names->push_back(Sha256Hex("plum"));
    return names;
  }
};

TEST(ObjectUploadFaultTest, AnUploadThatEndsDuringTheSweepHindersNoStart) {
  LateListing files("/data");
  const auto store = DiskObjectStore::Open("/data/objects", {}, files);
  EXPECT_TRUE(store.ok()) << store.status().message();
}

TEST(ObjectUploadFaultTest, APowerCutMakesNoTornObject) {
  const std::string plum = Sha256Hex("plum");
  for (int n = 0;; ++n) {
    SimulatedFileSystem files("/data");
    auto store = DiskObjectStore::Open("/data/objects", {}, files).value();
    files.FailAt(n, Internal("killed", ""), true);
    const auto sent = [&]() -> Result<ObjectInfo> {
      DRUPE_ASSIGN_OR_RETURN(ObjectUpload upload, store->ResumeUpload(plum, 0, 4));
      DRUPE_RETURN_IF_ERROR(upload.Append(Bytes("plum")));
      return upload.Commit();
    }();
    const bool happened = files.Heal();
    files.PowerCut();
    store = DiskObjectStore::Open("/data/objects", {}, files).value();
    const auto read = store->Get(plum);
    EXPECT_EQ(read.ok() ? *read : read.status().code(), sent.ok() || read.ok() ? "plum" : "object_not_found");
    if (!happened) return;
  }
}

}  // namespace
}  // namespace drupe
