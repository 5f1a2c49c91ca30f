#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "jobs/sql/database.h"
#include "reconstruction/derived_cache.h"
#include "store/object_store.h"

namespace drupe {

/// A DerivedCache whose bytes are objects and whose keys are rows. What was used longest ago goes once all of it is
/// larger than a limit. A crash loses at most what was being kept, and leaves no object that no row names. Who has
/// waited for another's work as long as is patient does it too: a thread of low priority may hardly get on.
/// Thread-safe.
class ObjectDerivedCache : public DerivedCache {
 public:
  static constexpr std::chrono::milliseconds kPatience{2'000};

  /// `database` and `objects` must outlive the cache; `max_bytes` bounds the sum of what is kept.
  static Result<std::unique_ptr<ObjectDerivedCache>> Open(Database& database, ObjectStore& objects,
                                                          std::int64_t max_bytes,
                                                          std::chrono::milliseconds patience = kPatience);

  Result<std::string> FindOrMake(const std::string& key, const Make& make, const RunContext& context) override;
  std::optional<std::string> Find(const std::string& key) override;

  /// How often something was there, and how often it had to be made, since the start.
  std::int64_t hits() const { return hits_; }
  std::int64_t misses() const { return misses_; }

 private:
  class Turn;
  ObjectDerivedCache(Database& database, ObjectStore& objects, std::int64_t max_bytes,
                     std::chrono::milliseconds patience)
      : database_(database), objects_(objects), max_bytes_(max_bytes), patience_(patience) {}

  std::optional<std::string> Read(const std::string& key);
  Status Keep(const std::string& key, std::string_view bytes);
  Status MakeRoom();

  Database& database_;
  ObjectStore& objects_;
  const std::int64_t max_bytes_;
  const std::chrono::milliseconds patience_;
  std::atomic<std::int64_t> hits_{0}, misses_{0};
  std::mutex mutex_;
  std::condition_variable ended_;
  std::set<std::string> at_work_;  ///< guarded by mutex_: keys that a caller looks for or makes
};

}  // namespace drupe
