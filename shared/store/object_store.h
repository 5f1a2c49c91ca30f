#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/status.h"
#include "store/file_system.h"

namespace drupe {

/// The name and the length of a stored object.
struct ObjectInfo {
  std::string sha256;  ///< 64 lower-case hexadecimal digits
  std::uint64_t bytes = 0;

  bool operator==(const ObjectInfo&) const = default;
};

/// An object open for reading at any offset; its digest has been checked. Safe for several threads; outlives Remove.
class ObjectReader {
 public:
  std::uint64_t size() const { return size_; }
  /// Fills `buffer` from `offset`; returns the bytes read, fewer than asked for only at the object's end.
  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> buffer) const;

 private:
  friend class DiskObjectStore;
  ObjectReader(std::unique_ptr<ReadableFile> file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  std::unique_ptr<ReadableFile> file_;
  std::uint64_t size_;
};

/// Immutable objects named by the SHA-256 of their bytes, on this machine's disk (DiskObjectStore) or at another
/// machine's (RemoteObjectStore). An object whose Put returned OK survives a crash and a power cut; one that did not is
/// not seen by anybody. Thread-safe.
class ObjectStore {
 public:
  virtual ~ObjectStore() = default;

  /// Stores bytes; storing the same bytes again is fine, repairs a damaged copy, and counts as new for the collection
  /// of garbage. Errors: 413 `object_too_large`, 507 `disk_full`, `store_full`, 500 `write_failed`; then no object was
  /// added. 503 when another machine's store cannot be reached.
  virtual Result<ObjectInfo> Put(std::string_view bytes) = 0;
  /// The whole object, digest checked. Errors: 400 `invalid_digest`, 404 `object_not_found`, 413 `object_too_large`
  /// beyond max_bytes, 500 `object_damaged` (kDataLoss).
  virtual Result<std::string> Get(std::string_view sha256, std::uint64_t max_bytes = std::uint64_t{4} << 30) = 0;
  /// Opens an object for ranged reads; its digest has been checked. Errors as Get.
  virtual Result<std::unique_ptr<ObjectReader>> OpenObject(std::string_view sha256) = 0;
  virtual bool Contains(std::string_view sha256) = 0;
  /// Length in bytes, without reading it. Errors: 400 `invalid_digest`, 404 `object_not_found`.
  virtual Result<std::uint64_t> Size(std::string_view sha256) = 0;
  /// Deletes an object; one that is absent is fine. Readers that have it open go on.
  virtual Status Remove(std::string_view sha256) = 0;
  /// Whether a write would be admitted now, for /readyz. Errors: 507 `disk_full`, `store_full`.
  virtual Status CheckWritable(std::uint64_t expected_bytes) = 0;
  /// Says which objects `owner` (a service's name) refers to from now on, instead of those it said before. No other of
  /// its objects outlives the collection of garbage, unless stored after this. Errors: 400 `invalid_name`.
  virtual Status KeepRoots(const std::string& owner, const std::set<std::string>& digests) = 0;
};

}  // namespace drupe
