#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>

#include "base/status.h"
#include "store/file_system.h"

namespace drupe {

/// How many bytes the objects of a directory have, against a quota. Other processes add and remove objects too, so the
/// directory is counted again now and then, and before anything is refused. Thread-safe.
class StoreUsage {
 public:
  /// `quota` 0: no limit, and nothing is ever counted.
  StoreUsage(std::filesystem::path directory, FileSystem& files, std::uint64_t quota)
      : directory_(std::move(directory)), files_(files), quota_(quota) {}

  /// Errors: 507 `store_full` when `more` bytes would go beyond the quota.
  Status Admit(std::uint64_t more);
  /// Says that this process has stored an object.
  void Add(std::uint64_t bytes);

 private:
  using Clock = std::chrono::steady_clock;

  Status CountAgain(Clock::time_point now);

  const std::filesystem::path directory_;
  FileSystem& files_;
  const std::uint64_t quota_;
  std::mutex mutex_;
  std::uint64_t used_ = 0;
  Clock::time_point counted_at_ = {};  ///< the epoch: never
};

}  // namespace drupe
