#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "base/status.h"
#include "store/disk_object_store.h"

namespace drupe {

/// Copies of another machine's objects in a directory of bounded size; the least recently used go first. Several
/// processes may share the directory. Thread-safe.
class ObjectCache {
 public:
  /// Errors: those of DiskObjectStore::Open.
  static Result<std::unique_ptr<ObjectCache>> Open(const std::filesystem::path& directory, std::uint64_t max_bytes,
                                                   std::uint64_t min_free_bytes);

  DiskObjectStore& store() { return *store_; }
  /// Says that an object is in use now.
  void Used(std::string_view sha256);
  /// Makes room for an object of `bytes`, which one that is larger than the whole cache gets all of.
  Status MakeRoom(std::uint64_t bytes);

 private:
  ObjectCache(std::unique_ptr<DiskObjectStore> store, std::uint64_t max_bytes)
      : store_(std::move(store)), max_bytes_(max_bytes) {}

  std::unique_ptr<DiskObjectStore> store_;
  const std::uint64_t max_bytes_;
  std::mutex mutex_;
  std::map<std::string, std::int64_t, std::less<>> used_ns_;  ///< by this process; else the time of the file counts
};

}  // namespace drupe
