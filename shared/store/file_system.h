#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/status.h"

namespace drupe {

/// A new file being written. The writer holds an advisory lock on it for as long as it is open, which the kernel drops
/// when the process dies: a file whose lock can be taken has no writer left.
class WritableFile {
 public:
  virtual ~WritableFile() = default;
  /// Appends all of `bytes` or fails.
  virtual Status Append(std::span<const std::byte> bytes) = 0;
  /// Returns when the bytes are on the disk. After a failure the file must be given up: a second fsync may report
  /// success although the kernel has dropped the pages (PostgreSQL 15, data_sync_retry).
  virtual Status Sync() = 0;
};

/// What identifies a version of a file without reading it.
struct FileInfo {
  std::uint64_t size = 0;
  std::int64_t modified_ns = 0;
  std::uint64_t inode = 0;

  bool operator==(const FileInfo&) const = default;
};

/// A file being read; safe to use from several threads.
class ReadableFile {
 public:
  virtual ~ReadableFile() = default;
  /// Fills `buffer` from `offset`; returns the bytes read, fewer than asked for only at the end of the file.
  virtual Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> buffer) const = 0;
  virtual Result<FileInfo> Info() const = 0;
};

/// A lock on a path that is given back on destruction.
class PathLock {
 public:
  virtual ~PathLock() = default;
};

/// Every operating system call of the object store. Tests put a failing implementation in its place. Errors: 404
/// `file_not_found`, 507 `disk_full`, 500 `write_failed` with the operation and the path.
class FileSystem {
 public:
  virtual ~FileSystem() = default;
  /// The machine's file system.
  static FileSystem& Posix();

  /// Creates `path`, which must not exist, locked by this process.
  virtual Result<std::unique_ptr<WritableFile>> Create(const std::filesystem::path& path) = 0;
  /// Opens `path`, or creates it, to write at its end, locked by this process. Errors: 409 `upload_in_progress` while
  /// another writer has it.
  virtual Result<std::unique_ptr<WritableFile>> OpenToAppend(const std::filesystem::path& path) = 0;
  virtual Result<std::unique_ptr<ReadableFile>> Open(const std::filesystem::path& path) = 0;
  /// Creates a directory; one that exists already is fine.
  virtual Status CreateDirectory(const std::filesystem::path& path) = 0;
  virtual Status Rename(const std::filesystem::path& from, const std::filesystem::path& to) = 0;
  virtual Status Remove(const std::filesystem::path& path) = 0;
  /// Removes a file unless a living WritableFile, of any process, holds it. Returns whether it was removed.
  virtual Result<bool> RemoveIfAbandoned(const std::filesystem::path& path) = 0;
  /// Sets the time of modification to now.
  virtual Status Touch(const std::filesystem::path& path) = 0;
  /// Waits for the lock on `path`, which is created, among all processes: alone, or together with others that share it.
  virtual Result<std::unique_ptr<PathLock>> Lock(const std::filesystem::path& path, bool alone) = 0;
  virtual Status SyncDirectory(const std::filesystem::path& path) = 0;
  /// Names of the entries of a directory, in no order.
  virtual Result<std::vector<std::string>> List(const std::filesystem::path& path) = 0;
  /// Bytes that this process may still write on the file system of `path`.
  virtual Result<std::uint64_t> FreeBytes(const std::filesystem::path& path) = 0;
};

}  // namespace drupe
