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
#include "store/object_store.h"
#include "store/object_upload.h"
#include "store/store_usage.h"

namespace drupe {

struct ObjectStoreOptions {
  /// Writing is refused with 507 `disk_full` when less than this would be left, so that the job database beside the
  /// objects can still record what happened.
  std::uint64_t min_free_bytes = std::uint64_t{64} << 20;
  /// Most bytes that all objects may have together: 507 `store_full` beyond. 0: as many as the disk holds.
  std::uint64_t max_total_bytes = 0;
  /// Longest object, as a guard against a runaway writer.
  std::uint64_t max_object_bytes = std::uint64_t{16} << 30;
};

class DiskObjectStore;

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
  friend class DiskObjectStore;
  ObjectWriter(DiskObjectStore& store, std::filesystem::path temporary, std::unique_ptr<WritableFile> file);

  DiskObjectStore* store_;
  std::filesystem::path temporary_;  ///< empty once committed or moved from
  std::unique_ptr<WritableFile> file_;
  Sha256 digest_;
  std::uint64_t bytes_ = 0;
};

/// Immutable objects in a directory, named by the SHA-256 of their bytes: DIR/ab/abcdef... Several processes may share
/// the directory. Only 64 hexadecimal digits ever become part of a path.
class DiskObjectStore : public ObjectStore {
 public:
  /// Opens or creates the store in `directory` and sweeps what writers that died have left. `file_system` must outlive
  /// the store.
  static Result<std::unique_ptr<DiskObjectStore>> Open(std::filesystem::path directory,
                                                       const ObjectStoreOptions& options = {},
                                                       FileSystem& file_system = FileSystem::Posix());

  Result<ObjectInfo> Put(std::string_view bytes) override;
  Result<std::string> Get(std::string_view sha256, std::uint64_t max_bytes = std::uint64_t{4} << 30) override;
  /// The digest is checked the first time this process sees that file (by inode, size and modification time).
  Result<std::unique_ptr<ObjectReader>> OpenObject(std::string_view sha256) override;
  bool Contains(std::string_view sha256) override { return OpenFile(sha256).ok(); }
  Result<std::uint64_t> Size(std::string_view sha256) override;
  Status Remove(std::string_view sha256) override;
  Status CheckWritable(std::uint64_t expected_bytes = 0) override;
  Status KeepRoots(const std::string& owner, const std::set<std::string>& digests) override;

  /// Starts an object whose bytes come in pieces. `expected_bytes`, when known, lets a full disk refuse at once.
  Result<ObjectWriter> Begin(std::uint64_t expected_bytes = 0);
  /// Starts or goes on with the upload of an object of `total` bytes whose first `offset` are kept. Errors: 400
  /// `invalid_digest`; 409 `upload_offset` when other than `offset` bytes are kept, `upload_in_progress` while another
  /// client sends it; those of CheckWritable.
  Result<ObjectUpload> ResumeUpload(std::string_view sha256, std::uint64_t offset, std::uint64_t total);
  /// How many bytes of an unfinished upload are kept.
  Result<std::uint64_t> UploadedBytes(std::string_view sha256) const;
  /// Counts an object as new for the collection of garbage, as storing it again would. False: it is not there.
  Result<bool> Renew(std::string_view sha256);

  const std::filesystem::path& directory() const { return directory_; }

 private:
  friend class ObjectWriter;
  friend class ObjectUpload;
  DiskObjectStore(std::filesystem::path directory, const ObjectStoreOptions& options, FileSystem& file_system);

  Status CreateDirectories();
  Status SweepTemporaries();
  Status SweepUploads();
  Status CheckLength(std::uint64_t bytes) const;
  Result<std::filesystem::path> PathOf(std::string_view sha256) const;
  std::filesystem::path UploadPath(std::string_view sha256) const;
  Result<std::unique_ptr<ReadableFile>> OpenFile(std::string_view sha256) const;
  Status Publish(const std::filesystem::path& temporary, const ObjectInfo& object);
  Status CheckDigestOnce(const std::string& sha256, const ReadableFile& file, const FileInfo& info);

  const std::filesystem::path directory_;
  const ObjectStoreOptions options_;
  FileSystem& file_system_;
  StoreUsage usage_;
  std::mutex verified_mutex_;
  std::map<std::string, FileInfo, std::less<>> verified_;  ///< files whose digest this process has checked
};

}  // namespace drupe
