#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "reconstruction/derived_cache.h"

namespace drupe {

/// For tests: a cache in memory that counts what it had not.
class MemoryCache : public DerivedCache {
 public:
  Result<std::string> FindOrMake(const std::string& key, const Make& make, const RunContext&) override {
    if (std::optional<std::string> found = Find(key)) return *std::move(found);
    DRUPE_ASSIGN_OR_RETURN(std::string made, make());
    const std::lock_guard lock(mutex_);
    ++misses_;
    kept_[key] = made;
    return made;
  }

  std::optional<std::string> Find(const std::string& key) override {
    const std::lock_guard lock(mutex_);
    const auto found = kept_.find(key);
    return found == kept_.end() ? std::nullopt : std::optional(found->second);
  }

  /// How much was made since the last call.
  int TakeMisses() {
    const std::lock_guard lock(mutex_);
    const int misses = misses_;
    misses_ = 0;
    return misses;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::string> kept_;
  int misses_ = 0;
};

}  // namespace drupe
