#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>

#include "base/status.h"

namespace drupe {

/// What the users of a store refer to, as each of them has last said (ObjectStore::KeepRoots): one digest a line.
std::string RootsText(const std::set<std::string>& digests);
/// Errors: 400 `invalid_roots`.
Result<std::set<std::string>> ParseRoots(std::string_view text);

/// All that have been said about a store.
struct ObjectRoots {
  std::set<std::string> digests;
  std::set<std::string> owners;
  std::int64_t oldest_ns = 0;  ///< when the one that has been silent longest has spoken last; 0 without owners
};

/// Those of the store in `directory`, but for `except`. Errors: 400 `invalid_roots` when a file is damaged: then
/// nothing may be removed.
Result<ObjectRoots> ReadRoots(const std::filesystem::path& directory, const std::set<std::string>& except = {});

}  // namespace drupe
