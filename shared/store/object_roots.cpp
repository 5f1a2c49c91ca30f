#include "store/object_roots.h"

#include <algorithm>

#include "base/digest.h"
#include "base/files.h"
#include "base/ids.h"
#include "store/disk_object_store.h"
#include "store/object_files.h"

namespace drupe {

std::string RootsText(const std::set<std::string>& digests) {
  std::string text;
  for (const std::string& digest : digests) text.append(digest).append(1, '\n');
  return text;
}

Result<std::set<std::string>> ParseRoots(std::string_view text) {
  std::set<std::string> digests;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (!IsSha256Hex(line) || end == std::string_view::npos) {
      return InvalidArgument("invalid_roots", "one digest of 64 lower-case hexadecimal digits a line");
    }
    digests.emplace(line);
    text.remove_prefix(end + 1);
  }
  return digests;
}

Result<ObjectRoots> ReadRoots(const std::filesystem::path& directory, const std::set<std::string>& except) {
  FileSystem& files = FileSystem::Posix();
  ObjectRoots roots;
  const Result<std::vector<std::string>> names = files.List(directory / kRootsFolder);
  if (!names.ok() && names.status().kind() == StatusKind::kNotFound) return roots;  // of an older version
  DRUPE_RETURN_IF_ERROR(names.status());
  for (const std::string& name : *names) {
    if (except.contains(name) || !CheckImageName(name).ok() || name.find(".tmp.") != std::string::npos) continue;
    const std::filesystem::path path = directory / kRootsFolder / name;
    DRUPE_ASSIGN_OR_RETURN(const auto file, files.Open(path));
    DRUPE_ASSIGN_OR_RETURN(const FileInfo info, file->Info());
    DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path));
    DRUPE_ASSIGN_OR_RETURN(std::set<std::string> digests, ParseRoots(text));
    roots.oldest_ns = roots.owners.empty() ? info.modified_ns : std::min(roots.oldest_ns, info.modified_ns);
    roots.owners.insert(name);
    roots.digests.merge(digests);
  }
  return roots;
}

Status DiskObjectStore::KeepRoots(const std::string& owner, const std::set<std::string>& digests) {
  DRUPE_RETURN_IF_ERROR(CheckImageName(owner));
  return WriteFileAtomically(directory_ / kRootsFolder / owner, RootsText(digests));
}

}  // namespace drupe
