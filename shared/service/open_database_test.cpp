#include "service/open_database.h"

#include <gtest/gtest.h>

#include "base/ids.h"

namespace drupe {
namespace {

namespace fs = std::filesystem;

TEST(OpenDatabase, SqliteLiesInTheDataDirectoryOrWhereItIsSaid) {
  const fs::path data = fs::temp_directory_path() / NewId("opendb");
  fs::create_directories(data);
  EXPECT_TRUE(OpenDatabase("", data, "analysis").ok());
  EXPECT_TRUE(fs::exists(data / "analysis.db"));
  EXPECT_TRUE(OpenDatabase("sqlite:" + (data / "other.db").string(), data, "analysis").ok());
  EXPECT_TRUE(fs::exists(data / "other.db"));
  fs::remove_all(data);
}

TEST(OpenDatabase, RefusesOtherUrlsWithoutRepeatingThem) {
  for (const char* url : {"mysql://u:secret@h/d", "sqlite:", "reconstruction.db"}) {
    const auto opened = OpenDatabase(url, ".", "analysis");
    EXPECT_EQ(opened.status().code(), "invalid_jobs_url") << url;
    EXPECT_EQ(opened.status().message().find("secret"), std::string::npos);
  }
}

TEST(OpenDatabase, UnreachablePostgresIsUnavailable) {
  const auto opened = OpenDatabase("postgres:///d?host=/nonexistent", ".", "analysis");
  EXPECT_EQ(opened.status().code(), "database_unreachable");
}

}  // namespace
}  // namespace drupe
