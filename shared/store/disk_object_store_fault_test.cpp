#include <gtest/gtest.h>

#include "base/digest.h"
#include "store/disk_object_store.h"
#include "store/simulated_file_system.h"

namespace drupe {
namespace {

const std::filesystem::path kRoot = "/data";

Status DiskFull() {
  return {StatusKind::kInsufficientStorage, "disk_full", "no space left"};
}

std::unique_ptr<DiskObjectStore> OpenStore(FileSystem& file_system) {
  auto store = DiskObjectStore::Open(kRoot / "objects", {}, file_system);
  EXPECT_TRUE(store.ok()) << store.status().ToString();
  return std::move(store).value();
}

/// Puts `text` in two pieces.
Result<ObjectInfo> PutInPieces(DiskObjectStore& store, std::string_view text) {
  DRUPE_ASSIGN_OR_RETURN(ObjectWriter writer, store.Begin());
  DRUPE_RETURN_IF_ERROR(writer.Append(text.substr(0, 2)));
  DRUPE_RETURN_IF_ERROR(writer.Append(text.substr(2)));
  return writer.Commit();
}

/// A reopened store has the object whole or not at all, nothing unfinished, and takes the object again.
void ExpectClean(SimulatedFileSystem& file_system, bool acknowledged, std::string_view text) {
  auto store = OpenStore(file_system);
  EXPECT_EQ(file_system.FileCount(kRoot / "objects" / "tmp"), 0);
  const auto read = store->Get(Sha256Hex(text));
  if (acknowledged || read.ok()) {
    ASSERT_TRUE(read.ok()) << read.status().ToString();
    EXPECT_EQ(*read, text);
  } else {
    EXPECT_EQ(read.status().code(), "object_not_found");
  }
  EXPECT_EQ(store->Get(Sha256Hex("old")).value(), "old");
  EXPECT_TRUE(PutInPieces(*store, text).ok());
  EXPECT_EQ(store->Get(Sha256Hex(text)).value(), text);
}

TEST(ObjectStoreFaultTest, EveryFailedCallIsReportedAndLeavesNothingBehind) {
  for (int n = 0;; ++n) {
    SimulatedFileSystem file_system(kRoot);
    auto store = OpenStore(file_system);
    ASSERT_TRUE(store->Put("old").ok());
    file_system.FailAt(n, DiskFull(), false);
    const auto put = PutInPieces(*store, "plum");
    if (!file_system.Heal()) {
      ASSERT_TRUE(put.ok());
      EXPECT_GE(n, 6) << "create, two writes, fsync, rename and directory fsync";
      return;
    }
    EXPECT_EQ(put.status().kind(), StatusKind::kInsufficientStorage) << n;
    EXPECT_EQ(file_system.FileCount(kRoot / "objects" / "tmp"), 0) << n;
    ExpectClean(file_system, false, "plum");
  }
}

TEST(ObjectStoreFaultTest, KilledOrCutOffAtEveryCallLosesNothingAcknowledged) {
  for (const bool power_cut : {false, true}) {
    for (int n = 0;; ++n) {
      SimulatedFileSystem file_system(kRoot);
      auto store = OpenStore(file_system);
      ASSERT_TRUE(store->Put("old").ok());
      file_system.FailAt(n, Internal("killed", ""), true);
      const auto put = PutInPieces(*store, "plum");
      const bool happened = file_system.Heal();
      power_cut ? file_system.PowerCut() : file_system.KillProcess();
      ExpectClean(file_system, put.ok(), "plum");
      if (!happened) break;
      EXPECT_FALSE(put.ok());
    }
  }
}

TEST(ObjectStoreFaultTest, OpeningIsRepeatableWhereverItWasInterrupted) {
  for (int n = 0;; n += 37) {
    SimulatedFileSystem file_system(kRoot);
    file_system.FailAt(n, Internal("killed", ""), true);
    const bool opened = DiskObjectStore::Open(kRoot / "objects", {}, file_system).ok();
    const bool happened = file_system.Heal();
    EXPECT_EQ(opened, !happened);
    file_system.PowerCut();
    EXPECT_TRUE(OpenStore(file_system)->Put("plum").ok());
    if (!happened) return;
  }
}

TEST(ObjectStoreFaultTest, KeepsAReserveOnTheDisk) {
  SimulatedFileSystem file_system(kRoot);
  auto store = OpenStore(file_system);
  const std::uint64_t reserve = ObjectStoreOptions{}.min_free_bytes;
  file_system.set_free_bytes(reserve + 4);
  EXPECT_TRUE(store->Put("plum").ok());
  EXPECT_EQ(store->Put("plums").status().code(), "disk_full");
  EXPECT_TRUE(store->CheckWritable(4).ok());
  file_system.set_free_bytes(reserve - 1);
  EXPECT_EQ(store->CheckWritable().kind(), StatusKind::kInsufficientStorage);
}

}  // namespace
}  // namespace drupe
