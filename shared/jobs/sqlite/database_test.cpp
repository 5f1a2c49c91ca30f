#include "jobs/sqlite/database.h"

#include <gtest/gtest.h>

#include "base/ids.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

constexpr auto kPowerCut = Durability::kPowerCut;

class SqliteDatabaseTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(directory_); }
  void TearDown() override { fs::remove_all(directory_); }

  std::unique_ptr<SqliteDatabase> Open() { return SqliteDatabase::Open(directory_ / "test.db").value(); }
  static Status Insert(SqliteDatabase& database, std::string_view text) {
    return database.Transaction(kPowerCut, [&]() -> Status {
      DRUPE_ASSIGN_OR_RETURN(const auto insert, database.Prepare("INSERT INTO t VALUES (?)"));
      return insert->Bind(text).Run();
    });
  }
  static std::int64_t Count(SqliteDatabase& database) {
    std::int64_t count = -1;
    EXPECT_TRUE(database
                    .Transaction(kPowerCut,
                                 [&]() -> Status {
                                   DRUPE_ASSIGN_OR_RETURN(const auto query, database.Prepare("SELECT COUNT(*) FROM t"));
                                   DRUPE_RETURN_IF_ERROR(query->Step().status());
                                   count = query->Int(0);
                                   return Status::Ok();
                                 })
                    .ok());
    return count;
  }

  const fs::path directory_ = fs::temp_directory_path() / NewId("dbtest");
};

TEST_F(SqliteDatabaseTest, OneProcessOwnsTheFile) {
  auto owner = Open();
  const auto second = SqliteDatabase::Open(directory_ / "test.db");
  EXPECT_EQ(second.status().code(), "database_in_use");
  EXPECT_NE(second.status().message().find("test.db"), std::string::npos);
  owner.reset();
  EXPECT_TRUE(SqliteDatabase::Open(directory_ / "test.db").ok());
}

TEST_F(SqliteDatabaseTest, MigratesStepByStepAndRefusesALaterVersion) {
  auto database = Open();
  ASSERT_TRUE(database->Migrate("c", {"CREATE TABLE t (x TEXT)"}).ok());
  ASSERT_TRUE(Insert(*database, "kept").ok());
  ASSERT_TRUE(database->Migrate("c", {"not run again", "ALTER TABLE t ADD COLUMN y TEXT"}).ok());
  EXPECT_EQ(Count(*database), 1);
  EXPECT_EQ(database->Migrate("c", {"CREATE TABLE t (x TEXT)"}).code(), "database_newer");
}

TEST_F(SqliteDatabaseTest, FailedMigrationLeavesTheFormerVersion) {
  auto database = Open();
  EXPECT_EQ(database->Migrate("c", {"CREATE TABLE t (x TEXT)", "nonsense"}).code(), "database_failed");
  EXPECT_TRUE(database->Migrate("c", {"CREATE TABLE t (x TEXT)"}).ok());
}

TEST_F(SqliteDatabaseTest, FailedTransactionChangesNothing) {
  auto database = Open();
  ASSERT_TRUE(database->Migrate("c", {"CREATE TABLE t (x TEXT)"}).ok());
  const Status failed = database->Transaction(kPowerCut, [&]() -> Status {
    DRUPE_RETURN_IF_ERROR(database->Execute("INSERT INTO t VALUES ('a')"));
    return NotFound("nothing", "");
  });
  EXPECT_EQ(failed.code(), "nothing");
  EXPECT_EQ(Count(*database), 0);
}

TEST_F(SqliteDatabaseTest, FullDiskIsReportedAndOvercome) {
  auto database = Open();
  ASSERT_TRUE(database->Migrate("c", {"CREATE TABLE t (x TEXT)"}).ok());
  ASSERT_TRUE(Insert(*database, "kept").ok());
  // A limit on the pages makes SQLite see a full disk.
  ASSERT_TRUE(database->Execute("PRAGMA max_page_count=10").ok());
  const Status full = Insert(*database, std::string(1'000'000, 'x'));
  EXPECT_EQ(full.kind(), StatusKind::kInsufficientStorage) << full.ToString();
  ASSERT_TRUE(database->Execute("PRAGMA max_page_count=1000000").ok());
  EXPECT_EQ(Count(*database), 1);
  EXPECT_TRUE(Insert(*database, std::string(1'000'000, 'x')).ok());
}

TEST_F(SqliteDatabaseTest, CannotBeOpenedWhereThereIsNoDirectory) {
  EXPECT_FALSE(SqliteDatabase::Open(directory_ / "absent" / "test.db").ok());
}

}  // namespace
}  // namespace drupe
