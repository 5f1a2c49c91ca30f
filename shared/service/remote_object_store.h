#pragma once

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "base/status.h"
#include "http/client.h"
#include "service/object_cache.h"
#include "store/object_store.h"

namespace drupe {

struct RemoteStoreOptions {
  std::uint64_t cache_bytes = std::uint64_t{8} << 30;
  std::uint64_t min_free_bytes = std::uint64_t{64} << 20;  ///< on the disk of the cache
  std::uint64_t piece_bytes = std::uint64_t{8} << 20;      ///< of an upload, sent at a time
  std::chrono::milliseconds patience{60'000};              ///< that a transfer goes on without a byte
  std::chrono::milliseconds first_pause{100};              ///< before trying again; doubles up to two seconds
  ClientOptions client = {};
};

/// The objects of another machine, over its service's routes /objects, with copies of those in use in a cache on this
/// one. Transfers go on where they broke off; every object's digest is checked here when it is read and there when it
/// is written. Errors beyond those of ObjectStore: 503 `unreachable` once the patience is used up, 401, 403.
class RemoteObjectStore : public ObjectStore {
 public:
  /// `url` is http://host:port. Errors: 400 `invalid_url`; those of ObjectCache::Open.
  static Result<std::unique_ptr<RemoteObjectStore>> Open(const std::string& url, const std::filesystem::path& cache,
                                                         const RemoteStoreOptions& options = {});

  Result<ObjectInfo> Put(std::string_view bytes) override;
  Result<std::string> Get(std::string_view sha256, std::uint64_t max_bytes = std::uint64_t{4} << 30) override;
  Result<std::unique_ptr<ObjectReader>> OpenObject(std::string_view sha256) override;
  bool Contains(std::string_view sha256) override { return Size(sha256).ok(); }
  Result<std::uint64_t> Size(std::string_view sha256) override;
  Status Remove(std::string_view sha256) override;
  Status CheckWritable(std::uint64_t expected_bytes) override;
  Status KeepRoots(const std::string& owner, const std::set<std::string>& digests) override;

 private:
  RemoteObjectStore(Client client, std::unique_ptr<ObjectCache> cache, const RemoteStoreOptions& options)
      : client_(std::move(client)), cache_(std::move(cache)), options_(options) {}

  /// Calls `step` until it is done, with pauses while the other machine is away; `progress` counts bytes.
  Status Insist(const std::function<Status()>& step, const std::uint64_t& progress) const;
  Status Upload(const std::string& sha256, std::string_view bytes) const;
  Status Fetch(const std::string& sha256);
  /// Runs `read` on the cache's copy, which is fetched first when it is not there or damaged.
  template <typename T>
  Result<T> Read(std::string_view sha256, const std::function<Result<T>(DiskObjectStore&)>& read);

  const Client client_;
  const std::unique_ptr<ObjectCache> cache_;
  const RemoteStoreOptions options_;
  std::array<std::mutex, 64> fetching_;  ///< by digest, so that two threads do not fetch the same object at once
};

}  // namespace drupe
