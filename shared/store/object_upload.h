#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "base/status.h"
#include "store/file_system.h"
#include "store/object_store.h"

namespace drupe {

class DiskObjectStore;

/// An object that another machine sends, under the digest that it says the bytes have. What has been appended stays
/// when the connection breaks, so that the sender can go on there; only one sender at a time (the file is locked).
class ObjectUpload {
 public:
  /// Errors: 413 `object_too_large` beyond the announced length, 507 `disk_full`, 500 `write_failed`.
  Status Append(std::span<const std::byte> bytes);
  /// Bytes kept so far.
  std::uint64_t bytes() const { return bytes_; }
  bool complete() const { return bytes_ == total_; }
  /// Makes a complete upload an object. Errors: 422 `digest_mismatch` when the bytes have another digest; then none of
  /// them is kept. Otherwise as Append.
  Result<ObjectInfo> Commit();

 private:
  friend class DiskObjectStore;
  ObjectUpload(DiskObjectStore& store, std::string sha256, std::filesystem::path path,
               std::unique_ptr<WritableFile> file, std::uint64_t bytes, std::uint64_t total)
      : store_(&store),
        sha256_(std::move(sha256)),
        path_(std::move(path)),
        file_(std::move(file)),
        bytes_(bytes),
        total_(total) {}

  DiskObjectStore* store_;
  std::string sha256_;
  std::filesystem::path path_;
  std::unique_ptr<WritableFile> file_;
  std::uint64_t bytes_, total_;
};

}  // namespace drupe
