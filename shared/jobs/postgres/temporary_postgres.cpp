#include "jobs/postgres/temporary_postgres.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "base/files.h"
#include "base/ids.h"

namespace drupe {

namespace {

constexpr int kLooks = 900;  ///< of 100 ms each
constexpr std::size_t kMaxTextBytes = 10'000;

}  // namespace

const TemporaryPostgres& TemporaryPostgres::Get() {
  static const TemporaryPostgres kServer;
  return kServer;
}

TemporaryPostgres::TemporaryPostgres() {
  const std::filesystem::path directory = std::filesystem::temp_directory_path() / NewId("pg");
  const std::string command = "exec /usr/bin/python3 " DRUPE_TEST_DATA "/../postgres/cluster.py " + directory.string();
  // Never closed: when this process ends, however it does, so does the script's input, and it takes the server down.
  if (::popen(command.c_str(), "w") == nullptr) {
    reason_ = "the script that starts PostgreSQL could not be run";
    return;
  }
  for (int look = 0; look < kLooks; ++look) {
    if (const auto url = ReadFile(directory / "url", kMaxTextBytes); url.ok()) {
      url_ = *url;
      return;
    }
    if (const auto reason = ReadFile(directory / "skip", kMaxTextBytes); reason.ok()) {
      reason_ = *reason;
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  reason_ = "PostgreSQL did not start";
}

}  // namespace drupe
