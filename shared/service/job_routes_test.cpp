#include "service/job_routes.h"

#include <gtest/gtest.h>

#include "base/ids.h"
#include "jobs/sql/sql_job_store.h"
#include "service/open_database.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

class JobRoutesTest : public testing::Test {
 protected:
  JobRoutesTest() {
    fs::create_directories(data_);
    database_ = OpenDatabase("", data_, "test").value();
    jobs_ = OpenJobStore(*database_).value();
    AddJobRoutes(router_, *jobs_);
  }
  ~JobRoutesTest() override { fs::remove_all(data_); }

  Response Call(std::string_view method, std::string_view path,
                std::map<std::string, std::string, std::less<>> query = {}) {
    Request request;
    request.query = std::move(query);
    std::string allowed;
    Response response;
    const auto route = router_.Find(method, path, request, allowed);
    EXPECT_TRUE(route.ok()) << path;
    if (route.ok()) (*route)->handler(request, response);
    return response;
  }
  std::string DeadJob() {
    (void)jobs_->Submit({.kind = "work"}).value();
    const Job job = *jobs_->Claim({"work"}, "w", 1000).value();
    EXPECT_TRUE(jobs_->Fail(job.id, job.attempt, {"broken", "why it broke", ""}, false).ok());
    return job.id;
  }

  const fs::path data_ = fs::temp_directory_path() / NewId("jobroutes");
  std::unique_ptr<Database> database_;
  std::unique_ptr<JobStore> jobs_;
  Router router_;
};

TEST_F(JobRoutesTest, ListsDeadLettersWithTheirReasons) {
  const std::string dead = DeadJob();
  (void)jobs_->Submit({.kind = "work"});
  const Json page = ParseJson(Call("GET", "/jobs", {{"state", "failed"}}).body).value();
  ASSERT_EQ(page["jobs"].size(), 1u);
  EXPECT_EQ(page["jobs"][0]["id"], dead);
  EXPECT_EQ(page["jobs"][0]["error"]["message"], "why it broke");
  EXPECT_TRUE(page["next_cursor"].is_null());
  EXPECT_EQ(Call("GET", "/jobs", {{"state", "dead"}}).status, 400);
  EXPECT_EQ(Call("GET", "/jobs", {{"limit", "0"}}).status, 400);
}

TEST_F(JobRoutesTest, ShowsTheHistoryOfOne) {
  const Json job = ParseJson(Call("GET", "/jobs/" + DeadJob()).body).value();
  ASSERT_EQ(job["history"].size(), 3u);
  EXPECT_EQ(job["history"][2]["reason"], "failed: broken");
  EXPECT_EQ(Call("GET", "/jobs/job_unknown").status, 404);
}

TEST_F(JobRoutesTest, RetriesAndCancels) {
  const std::string dead = DeadJob();
  EXPECT_EQ(ParseJson(Call("POST", "/jobs/" + dead + "/retry").body).value()["status"], "queued");
  EXPECT_EQ(Call("POST", "/jobs/" + dead + "/retry").status, 409);
  EXPECT_EQ(ParseJson(Call("POST", "/jobs/" + dead + "/cancel").body).value()["status"], "cancelled");
}

}  // namespace
}  // namespace drupe
