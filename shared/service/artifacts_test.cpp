#include "service/artifacts.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/ids.h"
#include "store/disk_object_store.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

class ArtifactsTest : public testing::Test {
 protected:
  void TearDown() override { fs::remove_all(directory_); }

  Status Send(const std::string& name, Response& response, const std::string& range = "") {
    Request request;
    request.captures["name"] = name;
    if (!range.empty()) request.headers.emplace("Range", range);
    return SendArtifact(request, job_, artifacts_, *objects_, response);
  }

  const fs::path directory_ = fs::temp_directory_path() / NewId("artifactstest");
  std::unique_ptr<ObjectStore> objects_ = DiskObjectStore::Open(directory_).value();
  Job job_;
  std::vector<Artifact> artifacts_ =
      StoreArtifacts({{"b.png", "picture"}, {"a.json", "{}"}, {"c.ply", "ply"}}, *objects_).value();
};

TEST_F(ArtifactsTest, AreListedByNameWithTheirTypes) {
  const Json list = ToJson(artifacts_);
  ASSERT_EQ(list.size(), 3u);
  EXPECT_EQ(list[0]["name"], "a.json");
  EXPECT_EQ(list[1]["type"], "image/png");
  EXPECT_EQ(list[1]["bytes"], 7);
  EXPECT_EQ(list[2]["type"], "application/octet-stream");
  EXPECT_EQ(ParseArtifacts(list), artifacts_);
  EXPECT_TRUE(ParseArtifacts(Json(nullptr)).empty());
  EXPECT_TRUE(ParseArtifacts({{{"name", 1}}}).empty());
}

TEST_F(ArtifactsTest, AreSentWholeAndInParts) {
  Response whole, part;
  ASSERT_TRUE(Send("b.png", whole).ok());
  EXPECT_EQ(whole.status, 200);
  EXPECT_EQ(whole.content_type, "image/png");
  EXPECT_EQ(whole.source_length, 7u);
  ASSERT_TRUE(Send("b.png", part, "bytes=2-3").ok());
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.source_length, 2u);
}

TEST_F(ArtifactsTest, MissingOnesTellTheStateOfTheJob) {
  Response response;
  job_.state = JobState::kRunning;
  const Status missing = Send("d.png", response);
  EXPECT_EQ(missing.code(), "artifact_not_found");
  EXPECT_NE(missing.message().find("running"), std::string::npos) << missing.message();
}

}  // namespace
}  // namespace drupe
