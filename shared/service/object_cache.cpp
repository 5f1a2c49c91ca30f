#include "service/object_cache.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "store/object_files.h"

namespace drupe {

Result<std::unique_ptr<ObjectCache>> ObjectCache::Open(const std::filesystem::path& directory, std::uint64_t max_bytes,
                                                       std::uint64_t min_free_bytes) {
  DRUPE_ASSIGN_OR_RETURN(auto store, DiskObjectStore::Open(directory, {.min_free_bytes = min_free_bytes}));
  return std::unique_ptr<ObjectCache>(new ObjectCache(std::move(store), max_bytes));
}

void ObjectCache::Used(std::string_view sha256) {
  const std::lock_guard lock(mutex_);
  used_ns_[std::string(sha256)] = Clock::System().NowMs() * 1'000'000;
}

// The directory is listed each time, since others fill it too; that takes far less than the transfer it makes room for.
Status ObjectCache::MakeRoom(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  DRUPE_ASSIGN_OR_RETURN(const auto objects, ListObjects(store_->directory(), FileSystem::Posix()));
  std::uint64_t total = bytes;
  std::vector<std::tuple<std::int64_t, std::uint64_t, std::string>> oldest_first;
  for (const auto& [digest, info] : objects) {
    const auto used = used_ns_.find(digest);
    const std::int64_t at = std::max(info.modified_ns, used == used_ns_.end() ? 0 : used->second);
    oldest_first.emplace_back(at, info.size, digest);
    total += info.size;
  }
  std::erase_if(used_ns_, [&](const auto& used) { return !objects.contains(used.first); });  // removed by another
  std::sort(oldest_first.begin(), oldest_first.end());
  for (const auto& [at, size, digest] : oldest_first) {
    if (total <= max_bytes_) break;
    DRUPE_RETURN_IF_ERROR(store_->Remove(digest));
    used_ns_.erase(digest);
    total -= size;
  }
  return Status::Ok();
}

}  // namespace drupe
