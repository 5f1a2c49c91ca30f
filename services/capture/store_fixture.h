#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>

#include "base/ids.h"
#include "jobs/sqlite/database.h"
#include "store/disk_object_store.h"

namespace drupe {

/// A test over an object store and a database in a directory of their own, which goes with it.
class StoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(directory_);
    auto objects = DiskObjectStore::Open(directory_ / "objects");
    auto database = SqliteDatabase::Open(directory_ / "capture.db");
    ASSERT_TRUE(objects.ok() && database.ok());
    objects_ = std::move(*objects), database_ = std::move(*database);
  }
  ~StoreTest() override {
    database_.reset();
    std::filesystem::remove_all(directory_);
  }

  /// A store whose rows are in the database.
  template <typename Store>
  std::unique_ptr<Store> Open() {
    auto store = Store::Open(*database_);
    EXPECT_TRUE(store.ok()) << store.status().ToString();
    return store.ok() ? std::move(*store) : nullptr;
  }

  const std::filesystem::path directory_ = std::filesystem::temp_directory_path() / NewId("capture");
  std::unique_ptr<ObjectStore> objects_;
  std::unique_ptr<SqliteDatabase> database_;
};

}  // namespace drupe
