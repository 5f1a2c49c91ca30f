#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

#include "base/digest.h"
#include "base/status.h"
#include "store/file_system.h"

namespace drupe {

/// The name and the length of a stored object.
struct ObjectInfo {
  std::string sha256;  ///< 64 lower-case hexadecimal digits
  std::uint64_t bytes = 0;

  bool operator==(const ObjectInfo&) const = default;
};

struct ObjectStoreOptions {
  /// Writing is refused with 507 `disk_full` when less than this would be left, so that the job database beside the
  /// objects can still record what happened.
  std::uint64_t min_free_bytes = std::uint64_t{64} << 20;
  /// Longest object, as a guard against a runaway writer.
  std::uint64_t max_object_bytes = std::uint64_t{16} << 30;
};

class ObjectStore;

/// Writes one object piece by piece. Without Commit nothing of it remains. Not safe for several threads.
class ObjectWriter {
 public:
  ~ObjectWriter();
  ObjectWriter(ObjectWriter&&) noexcept;
  ObjectWriter& operator=(ObjectWriter&&) = delete;

  /// Errors: 413 `object_too_large`, 507 `disk_full`, 500 `write_failed`. After an error only destruction is left.
  Status Append(std::span<const std::byte> bytes);
  Status Append(std::string_view text);
  /// Bytes appended so far.
  std::uint64_t bytes() const { return bytes_; }
  /// Makes the object durable under its digest and readable. Call once. Errors as Append; then no object was added.
  Result<ObjectInfo> Commit();

 private:
  friend class ObjectStore;
  ObjectWriter(ObjectStore& store, std::filesystem::path temporary, std::unique_ptr<WritableFile> file);

  ObjectStore* store_;
  std::filesystem::path temporary_;  ///< empty once committed or moved from
  std::unique_ptr<WritableFile> file_;
  Sha256 digest_;
  std::uint64_t bytes_ = 0;
};

/// An object open for reading at any offset; its digest has been checked. Safe for several threads; outlives Remove.
class ObjectReader {
 public:
  std::uint64_t size() const { return size_; }
  /// Fills `buffer` from `offset`; returns the bytes read, fewer than asked for only at the object's end.
  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> buffer) const;

 private:
  friend class ObjectStore;
  ObjectReader(std::unique_ptr<ReadableFile> file, std::uint64_t size) : file_(std::move(file)), size_(size) {}

  std::unique_ptr<ReadableFile> file_;
  std::uint64_t size_;
};

/// Immutable objects in a directory, named by the SHA-256 of their bytes: DIR/ab/abcdef... Several processes may share
/// the directory. An object whose Put or Commit returned OK survives a crash and a power cut; one that did not is not
/// seen by anybody. Only 64 hexadecimal digits ever become part of a path. Thread-safe.
class ObjectStore {
 public:
  /// Opens or creates the store in `directory` and sweeps what writers that died have left. `file_system` must outlive
  /// the store.
  static Result<std::unique_ptr<ObjectStore>> Open(std::filesystem::path directory,
                                                   const ObjectStoreOptions& options = {},
                                                   FileSystem& file_system = FileSystem::Posix());

  /// Stores bytes; storing the same bytes again is fine and repairs a damaged copy. Errors as ObjectWriter's.
  Result<ObjectInfo> Put(std::string_view bytes);
  /// Starts an object whose bytes come in pieces. `expected_bytes`, when known, lets a full disk refuse at once.
  Result<ObjectWriter> Begin(std::uint64_t expected_bytes = 0);

  /// The whole object, digest checked. Errors: 400 `invalid_digest`, 404 `object_not_found`, 413 `object_too_large`
  /// beyond max_bytes, 500 `object_damaged` (kDataLoss).
  Result<std::string> Get(std::string_view sha256, std::uint64_t max_bytes = std::uint64_t{4} << 30);
  /// Opens an object for ranged reads. The digest is checked the first time this process sees that file (by inode, size
  /// and modification time). Errors as Get.
  Result<std::unique_ptr<ObjectReader>> OpenObject(std::string_view sha256);
  bool Contains(std::string_view sha256) const;
  /// Length in bytes, without reading it. Errors: 400 `invalid_digest`, 404 `object_not_found`.
  Result<std::uint64_t> Size(std::string_view sha256) const;
  /// Deletes an object; one that is absent is fine. Readers that have it open go on.
  Status Remove(std::string_view sha256);

  /// Whether a write would be admitted now, for /readyz. Errors: 507 `disk_full`.
  Status CheckWritable(std::uint64_t expected_bytes = 0) const;

 private:
  friend class ObjectWriter;
  ObjectStore(std::filesystem::path directory, const ObjectStoreOptions& options, FileSystem& file_system);

  Status CreateDirectories();
  Status SweepTemporaries();
  Result<std::filesystem::path> PathOf(std::string_view sha256) const;
  Result<std::unique_ptr<ReadableFile>> OpenFile(std::string_view sha256) const;
  Status Publish(const std::filesystem::path& temporary, const std::string& sha256);
  Status CheckDigestOnce(const std::string& sha256, const ReadableFile& file, const FileInfo& info);

  const std::filesystem::path directory_;
  const ObjectStoreOptions options_;
  FileSystem& file_system_;
  std::mutex verified_mutex_;
  std::map<std::string, FileInfo, std::less<>> verified_;  ///< files whose digest this process has checked
};

}  // namespace drupe
