#include "http/service_options.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include <cstdlib>
#include <filesystem>

#include "base/files.h"
#include "base/ids.h"

namespace drupe {
namespace {

class ServiceOptionsTest : public testing::Test {
 protected:
  ServiceOptionsTest() { AddServiceOptions(app_, options_); }
  ~ServiceOptionsTest() override {
    std::filesystem::remove(file_);
    ::unsetenv("DRUPE_PORT");
  }

  /// Parses a command line, then a configuration file of this text; the error's code, "ok" or "parse_error".
  std::string Configure(const std::string& arguments, const std::string& config) {
    const Status written = WriteFileAtomically(file_, config);
    if (!written.ok()) return written.code();
    try {
      app_.parse(arguments);
      const Status status = ApplyConfigFile(app_, file_.string());
      return status.ok() ? "ok" : status.code();
    } catch (const CLI::ParseError&) {
      return "parse_error";
    }
  }

  CLI::App app_;
  ServiceOptions options_;
  const std::filesystem::path file_ = std::filesystem::temp_directory_path() / (NewId("test") + ".json");
};

TEST_F(ServiceOptionsTest, CommandLineThenEnvironmentThenFile) {
  ::setenv("DRUPE_PORT", "2000", 1);
  EXPECT_EQ(Configure("--host 0.0.0.0", R"({"host": "1.2.3.4", "port": 3000, "role": "worker", "max_image_mb": 0.5})"),
            "ok");
  EXPECT_EQ(options_.server.host, "0.0.0.0");
  EXPECT_EQ(options_.server.port, 2000);
  EXPECT_EQ(options_.role, Role::kWorker);
  EXPECT_EQ(options_.limits.max_image_bytes, std::size_t{1} << 19);
}

TEST_F(ServiceOptionsTest, BadFilesAreRefused) {
  EXPECT_EQ(Configure("", "[]"), "invalid_config");
  EXPECT_EQ(Configure("", "{"), "invalid_json");
  EXPECT_EQ(Configure("", R"({"colour": 1})"), "invalid_config");
  EXPECT_EQ(Configure("", R"({"help": true})"), "invalid_config");
  EXPECT_EQ(Configure("", R"({"port": [1]})"), "invalid_config");
  EXPECT_EQ(Configure("", R"({"port": 70000})"), "parse_error");
  EXPECT_EQ(Configure("", R"({"role": "boss"})"), "parse_error");
}

TEST(EnvironmentName, FromFlag) {
  EXPECT_EQ(EnvironmentName("--analysis-url"), "DRUPE_ANALYSIS_URL");
}

}  // namespace
}  // namespace drupe
