#include "service/references.h"

#include <gtest/gtest.h>

#include "base/digest.h"
#include "base/ids.h"
#include "jobs/sql/sql_job_store.h"
#include "service/open_database.h"

namespace drupe {
namespace {

TEST(ReferencedDigests, FindsThemInPayloadsAndInTablesOfTheService) {
  const auto data = std::filesystem::temp_directory_path() / NewId("refs");
  std::filesystem::create_directories(data);
  {
    const auto database = OpenDatabase("", data, "test").value();
    const auto jobs = OpenJobStore(*database).value();
    const std::string picture = Sha256Hex("picture"), report = Sha256Hex("report");
    ASSERT_TRUE(jobs->Submit({.kind = "work", .payload = {{"images", {{{"sha256", picture}}}}}}).ok());
    ASSERT_TRUE(
        database->Migrate("own", {"CREATE TABLE own (sha256 TEXT); INSERT INTO own VALUES ('" + report + "')"}).ok());
    EXPECT_EQ(ReferencedDigests(*database).value(), (std::set<std::string>{picture, report}));
  }
  std::filesystem::remove_all(data);
}

}  // namespace
}  // namespace drupe
