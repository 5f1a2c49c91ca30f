#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "store/file_system.h"

namespace drupe {

/// What a walk over all objects of a store has found.
struct StoreAudit {
  std::int64_t objects = 0;           ///< that are as they should be
  std::uint64_t bytes = 0;            ///< of those
  std::vector<std::string> damaged;   ///< digests whose bytes are others
  std::vector<std::string> misnamed;  ///< files among the objects that are none, as DIR/NAME
};

/// Reads every object in `directory` and compares its bytes with its name. Changes nothing; services may go on.
Result<StoreAudit> CheckObjects(const std::filesystem::path& directory, FileSystem& files = FileSystem::Posix());

/// Moves the damaged objects to `directory`/damaged, so that storing them again (or a copy from a backup) mends them
/// and readers are told that they are not there.
Status SetAside(const std::filesystem::path& directory, const std::vector<std::string>& damaged,
                FileSystem& files = FileSystem::Posix());

struct GarbageOptions {
  std::int64_t unused_since_ns = 0;  ///< objects modified later stay: something may be about to refer to them
  bool dry_run = false;              ///< counts, and removes nothing
};

struct GarbageReport {
  std::int64_t kept = 0, removed = 0;
  std::uint64_t kept_bytes = 0, removed_bytes = 0;
};

/// Removes the objects that nothing refers to: neither a digest in `roots`, nor a JSON object that is itself kept.
/// Whatever looks like a digest counts as one, so that no kind of reference can be forgotten.
Result<GarbageReport> CollectGarbage(const std::filesystem::path& directory, std::set<std::string> roots,
                                     const GarbageOptions& options, FileSystem& files = FileSystem::Posix());

/// Calls `found` for every 64 lower-case hexadecimal digits that stand alone in `text`.
void FindDigests(std::string_view text, const std::function<void(std::string)>& found);

}  // namespace drupe
