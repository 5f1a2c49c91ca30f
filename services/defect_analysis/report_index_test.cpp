#include "defect_analysis/report_index.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/ids.h"
#include "jobs/sqlite/database.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

class ReportIndexTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(directory_);
    database_ = SqliteDatabase::Open(directory_ / "analysis.db").value();
    index_ = ReportIndex::Open(*database_).value();
  }
  void TearDown() override {
    database_.reset();
    fs::remove_all(directory_);
  }

  /// Adds the current report number `n` with these grades, made at the second n.
  ReportEntry Add(int n, std::vector<DefectClass> grades) {
    ReportEntry entry;
    entry.job = "ana_" + std::to_string(n);
    entry.reconstruction = "rec_" + std::to_string(n);
    entry.created_ms = n * 1'000;
    entry.grades = std::move(grades);
    entry.defects = n;
    entry.json_sha256 = "j" + std::to_string(n);
    entry.csv_sha256 = "c" + std::to_string(n);
    entry.artifacts = {{"report.csv", entry.csv_sha256, 7}};
    EXPECT_TRUE(index_->SetCurrentJob(entry.reconstruction, entry.job).ok());
    EXPECT_TRUE(index_->Add(entry).ok());
    return entry;
  }
  std::vector<std::string> Listed(const ReportQuery& query) {
    std::vector<std::string> ids;
    const ReportPage page = index_->List(query).value();
    for (const ReportEntry& entry : page.reports) ids.push_back(entry.reconstruction);
    return ids;
  }

  const fs::path directory_ = fs::temp_directory_path() / NewId("indextest");
  std::unique_ptr<SqliteDatabase> database_;
  std::optional<ReportIndex> index_;
};

using Ids = std::vector<std::string>;

TEST_F(ReportIndexTest, FindsWhatWasAddedAndKeepsTheFirst) {
  const ReportEntry entry = Add(1, {DefectClass::kCrack, DefectClass::kIntact});
  EXPECT_EQ(index_->FindByJob("ana_1").value(), entry);
  ReportEntry again = entry;
  again.created_ms = 7;
  ASSERT_TRUE(index_->Add(again).ok());
  EXPECT_EQ(index_->FindByJob("ana_1").value(), entry);
  EXPECT_FALSE(index_->FindByJob("ana_2").value());
}

TEST_F(ReportIndexTest, FiltersByGradeAndTime) {
  Add(1, {DefectClass::kCrack, DefectClass::kIntact});
  Add(2, {DefectClass::kRainSpot});
  Add(3, {});
  EXPECT_EQ(Listed({}), (Ids{"rec_3", "rec_2", "rec_1"}));
  EXPECT_EQ(Listed({.grade = DefectClass::kIntact}), Ids{"rec_1"});
  EXPECT_EQ(Listed({.grade = DefectClass::kDecay}), Ids{});
  EXPECT_EQ(Listed({.since_ms = 2'000}), (Ids{"rec_3", "rec_2"}));
}

TEST_F(ReportIndexTest, PagesWithoutGapOrRepetitionWhileReportsArrive) {
  for (int n = 1; n <= 4; ++n) Add(n, {DefectClass::kScar});
  const ReportPage first = index_->List({.limit = 3}).value();
  EXPECT_EQ(first.reports.size(), 3u);
  Add(5, {DefectClass::kScar});
  const ReportPage second = index_->List({.limit = 3, .cursor = first.next_cursor}).value();
  ASSERT_EQ(second.reports.size(), 1u);
  EXPECT_EQ(second.reports[0].reconstruction, "rec_1");
  EXPECT_EQ(second.next_cursor, "");
  EXPECT_EQ(index_->List({.cursor = "-1"}).status().code(), "invalid_cursor");
}

TEST_F(ReportIndexTest, ListsOnlyTheCurrentReportOfAReconstruction) {
  Add(1, {DefectClass::kScar});
  ASSERT_TRUE(index_->SetCurrentJob("rec_1", "ana_later").ok());
  EXPECT_EQ(index_->CurrentJob("rec_1").value(), "ana_later");
  EXPECT_EQ(Listed({}), Ids{});
  EXPECT_FALSE(index_->CurrentJob("rec_2").value());
}

}  // namespace
}  // namespace drupe
