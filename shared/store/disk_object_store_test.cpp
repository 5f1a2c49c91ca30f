#include "store/disk_object_store.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#include "base/ids.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

constexpr ObjectStoreOptions kOptions{.min_free_bytes = 0, .max_object_bytes = 10'000'000};

class ObjectStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(fs::create_directories(directory_));
    store_ = OpenStore();
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::unique_ptr<DiskObjectStore> OpenStore() {
    auto store = DiskObjectStore::Open(directory_ / "objects", kOptions);
    EXPECT_TRUE(store.ok()) << store.status().ToString();
    return std::move(store).value();
  }
  fs::path FileOf(const std::string& sha256) const { return directory_ / "objects" / sha256.substr(0, 2) / sha256; }
  int Temporaries() const {
    return static_cast<int>(std::distance(fs::directory_iterator(directory_ / "objects" / "tmp"), {}));
  }

  const fs::path directory_ = fs::temp_directory_path() / NewId("storetest");
  std::unique_ptr<DiskObjectStore> store_;
};

std::string Read(ObjectReader& reader, std::uint64_t offset, std::size_t count) {
  std::string text(count, '\0');
  text.resize(reader.ReadAt(offset, std::as_writable_bytes(std::span(text))).value());
  return text;
}

TEST_F(ObjectStoreTest, GivesBackWhatWasPutUnderItsDigest) {
  const auto info = store_->Put("plum");
  ASSERT_TRUE(info.ok());
  EXPECT_EQ(info->sha256, Sha256Hex("plum"));
  EXPECT_EQ(info->bytes, 4u);
  EXPECT_EQ(store_->Get(info->sha256).value(), "plum");
  EXPECT_EQ(store_->Size(info->sha256).value(), 4u);
  EXPECT_TRUE(OpenStore()->Contains(info->sha256));
}

TEST_F(ObjectStoreTest, StoresTheEmptyObject) {
  const auto info = store_->Put("");
  ASSERT_TRUE(info.ok());
  EXPECT_EQ(store_->Get(info->sha256).value(), "");
}

TEST_F(ObjectStoreTest, WriterAddsPiecesAndLeavesNothingWithoutCommit) {
  {
    auto writer = store_->Begin();
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer->Append("half").ok());
    EXPECT_EQ(Temporaries(), 1);
  }
  EXPECT_EQ(Temporaries(), 0);
  auto writer = store_->Begin();
  ASSERT_TRUE(writer->Append("pl").ok());
  ASSERT_TRUE(writer->Append("um").ok());
  EXPECT_EQ(writer->Commit().value(), (ObjectInfo{Sha256Hex("plum"), 4}));
  EXPECT_EQ(Temporaries(), 0);
}

TEST_F(ObjectStoreTest, ReadsRanges) {
  const std::string sha256 = store_->Put("0123456789").value().sha256;
  auto reader = store_->OpenObject(sha256);
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ((*reader)->size(), 10u);
  EXPECT_EQ(Read(**reader, 3, 4), "3456");
  EXPECT_EQ(Read(**reader, 8, 4), "89");
  EXPECT_EQ(Read(**reader, 10, 4), "");
}

TEST_F(ObjectStoreTest, OnlyDigestsNameObjects) {
  for (const std::string& name : {std::string("../../etc/passwd"), std::string(""), std::string(63, 'a'),
                                  std::string(64, 'A'), "../" + std::string(61, 'a'), std::string(64, '/')}) {
    EXPECT_EQ(store_->Get(name).status().kind(), StatusKind::kInvalidArgument) << name;
    EXPECT_EQ(store_->Remove(name).kind(), StatusKind::kInvalidArgument) << name;
    EXPECT_FALSE(store_->Contains(name));
  }
  EXPECT_EQ(store_->Get(Sha256Hex("absent")).status().code(), "object_not_found");
}

TEST_F(ObjectStoreTest, DetectsDamageAndIsRepairedByStoringAgain) {
  const std::string sha256 = store_->Put("0123456789").value().sha256;
  for (const std::string_view damaged : {"0123456788", "012345678", "", "0123456789x"}) {
    std::ofstream(FileOf(sha256), std::ios::binary) << damaged;
    EXPECT_EQ(store_->Get(sha256).status().kind(), StatusKind::kDataLoss);
    EXPECT_EQ(OpenStore()->OpenObject(sha256).status().kind(), StatusKind::kDataLoss);
  }
  ASSERT_TRUE(store_->Put("0123456789").ok());
  EXPECT_EQ(store_->Get(sha256).value(), "0123456789");
}

TEST_F(ObjectStoreTest, RangedReadNoticesAFileThatChangedAfterItWasChecked) {
  const std::string sha256 = store_->Put("0123456789").value().sha256;
  ASSERT_TRUE(store_->OpenObject(sha256).ok());
  std::ofstream(FileOf(sha256), std::ios::binary) << "012345678!";
  // Some file systems stamp times only every few milliseconds.
  fs::last_write_time(FileOf(sha256), fs::file_time_type::clock::now() + std::chrono::seconds(1));
  EXPECT_EQ(store_->OpenObject(sha256).status().code(), "object_damaged");
}

TEST_F(ObjectStoreTest, RefusesObjectsBeyondTheLimits) {
  const std::string big(kOptions.max_object_bytes, 'x');
  EXPECT_TRUE(store_->Put(big).ok());
  EXPECT_EQ(store_->Put(big + "x").status().code(), "object_too_large");
  EXPECT_EQ(store_->Get(Sha256Hex(big), 100).status().code(), "object_too_large");
  EXPECT_EQ(Temporaries(), 0);
}

TEST_F(ObjectStoreTest, QuotaCountsWhatOtherProcessesStoreAndWhatWasThere) {
  ASSERT_TRUE(store_->Put("1234567").ok());
  const ObjectStoreOptions options{.min_free_bytes = 0, .max_total_bytes = 10};
  const auto store = DiskObjectStore::Open(directory_ / "objects", options).value();
  EXPECT_TRUE(store->CheckWritable(3).ok());
  EXPECT_EQ(store->Put("abcd").status().code(), "store_full");
  const std::string small = store->Put("abc").value().sha256;
  EXPECT_EQ(store->CheckWritable(1).kind(), StatusKind::kInsufficientStorage);
  const auto fresh = DiskObjectStore::Open(directory_ / "objects", options).value();
  EXPECT_EQ(fresh->Put("x").status().code(), "store_full");
  ASSERT_TRUE(fresh->Remove(small).ok());
  EXPECT_TRUE(DiskObjectStore::Open(directory_ / "objects", options).value()->Put("abc").ok());
}

TEST_F(ObjectStoreTest, RemovingLeavesOpenReadersAlone) {
  const std::string sha256 = store_->Put("plum").value().sha256;
  auto reader = store_->OpenObject(sha256);
  ASSERT_TRUE(store_->Remove(sha256).ok());
  EXPECT_FALSE(store_->Contains(sha256));
  EXPECT_EQ(Read(**reader, 0, 4), "plum");
  EXPECT_TRUE(store_->Remove(sha256).ok());
}

TEST_F(ObjectStoreTest, ManyWritersOfTheSameObjectsAllSucceed) {
  auto other = OpenStore();
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      ObjectStore& store = t % 2 == 0 ? *store_ : *other;
      for (int i = 0; i < 10; ++i) {
        const std::string content = "object " + std::to_string(i);
        EXPECT_TRUE(store.Put(content).ok());
        EXPECT_EQ(store.Get(Sha256Hex(content)).value(), content);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(Temporaries(), 0);
}

TEST_F(ObjectStoreTest, SweepSparesWritersThatLive) {
  auto writer = store_->Begin();
  ASSERT_TRUE(writer->Append("plum").ok());
  auto other = OpenStore();
  EXPECT_EQ(Temporaries(), 1);
  ASSERT_TRUE(writer->Commit().ok());
  EXPECT_EQ(other->Get(Sha256Hex("plum")).value(), "plum");
}

TEST_F(ObjectStoreTest, SweepsWhatAKilledProcessLeft) {
  const pid_t child = ::fork();
  if (child == 0) {
    auto writer = store_->Begin();
    (void)writer->Append("half");
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(Temporaries(), 1);
  OpenStore();
  EXPECT_EQ(Temporaries(), 0);
}

}  // namespace
}  // namespace drupe
