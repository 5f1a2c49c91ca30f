#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/status.h"

namespace drupe {

/// The whole content of a file. Errors: 404 `file_not_found`, 413 `file_too_large` beyond max_bytes.
Result<std::string> ReadFile(const std::filesystem::path& path, std::size_t max_bytes = std::size_t{1} << 32);

/// Replaces `path` with `content` so that a reader sees the old or the new file, never a part: temporary file beside it,
/// fsync, rename, fsync of the directory. Errors: 507 `disk_full`, 500 `write_failed`.
Status WriteFileAtomically(const std::filesystem::path& path, std::string_view content);

/// fsync of a directory, so that a rename in it survives a power cut.
Status SyncDirectory(const std::filesystem::path& directory);

/// The Status that a failed system call on `path` means; `error_number` is its errno.
Status StatusFromErrno(int error_number, std::string_view operation, const std::filesystem::path& path);

}  // namespace drupe
