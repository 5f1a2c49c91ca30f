#include "store/store_audit.h"

#include <algorithm>
#include <map>

#include "base/digest.h"
#include "base/hex.h"
#include "store/object_files.h"

namespace drupe {

namespace {

constexpr std::size_t kDigestDigits = 64;
/// JSON that refers to other objects is smaller; clouds and pictures are not searched.
constexpr std::uint64_t kMaxReferringBytes = std::uint64_t{16} << 20;

/// The digests that a kept object refers to, if it is a JSON object.
Result<std::vector<std::string>> ReferencesOf(const ReadableFile& file, std::uint64_t size) {
  std::vector<std::string> found;
  if (size == 0 || size > kMaxReferringBytes) return found;
  std::string content;
  DRUPE_RETURN_IF_ERROR(ReadAll(file, [&](std::string_view piece) { content += piece; }));
  if (content.starts_with('{')) {
    FindDigests(content, [&](std::string digest) { found.push_back(std::move(digest)); });
  }
  return found;
}

/// Adds to `kept` everything that can be reached from it.
Status KeepWhatIsReached(const std::filesystem::path& directory, const std::map<std::string, FileInfo>& objects,
                         std::set<std::string>& kept, FileSystem& files) {
  std::vector<std::string> open(kept.begin(), kept.end());
  while (!open.empty()) {
    const std::string digest = std::move(open.back());
    open.pop_back();
    const auto object = objects.find(digest);
    if (object == objects.end()) continue;
    const auto file = files.Open(directory / digest.substr(0, 2) / digest);
    if (!file.ok() && file.status().kind() == StatusKind::kNotFound) continue;
    DRUPE_RETURN_IF_ERROR(file.status());
    DRUPE_ASSIGN_OR_RETURN(const std::vector<std::string> references, ReferencesOf(**file, object->second.size));
    for (const std::string& reference : references) {
      if (kept.insert(reference).second) open.push_back(reference);
    }
  }
  return Status::Ok();
}

/// Removes an object unless it has been stored again, or renewed, since it was listed. Returns whether it was removed.
Result<bool> RemoveUnlessRenewed(const std::filesystem::path& directory, const std::string& digest,
                                 const FileInfo& listed, FileSystem& files) {
  const std::filesystem::path path = directory / digest.substr(0, 2) / digest;
  DRUPE_ASSIGN_OR_RETURN(const auto lock, files.Lock(directory / kCollectionLock, true));
  const auto file = files.Open(path);
  if (!file.ok()) return file.status().kind() == StatusKind::kNotFound ? Result<bool>(false) : file.status();
  DRUPE_ASSIGN_OR_RETURN(const FileInfo info, (*file)->Info());
  if (info != listed) return false;
  DRUPE_RETURN_IF_ERROR(files.Remove(path));
  return true;
}

}  // namespace

void FindDigests(std::string_view text, const std::function<void(std::string)>& found) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && IsHexDigit(text[i])) continue;
    if (i - begin == kDigestDigits) found(std::string(text.substr(begin, kDigestDigits)));
    begin = i + 1;
  }
}

Result<StoreAudit> CheckObjects(const std::filesystem::path& directory, FileSystem& files) {
  StoreAudit audit;
  DRUPE_RETURN_IF_ERROR(ForEachFile(directory, files, [&](const std::string& folder, const std::string& name) {
    if (!IsSha256Hex(name) || !name.starts_with(folder)) {
      audit.misnamed.push_back(folder + "/" + name);
      return Status::Ok();
    }
    const auto file = files.Open(directory / folder / name);
    if (!file.ok()) return file.status().kind() == StatusKind::kNotFound ? Status::Ok() : file.status();
    Sha256 digest;
    std::uint64_t bytes = 0;
    const Status read = ReadAll(**file, [&](std::string_view piece) {
      digest.Update(piece);
      bytes += piece.size();
    });
    if (!read.ok() || digest.FinishHex() != name) {
      audit.damaged.push_back(name);
      return Status::Ok();
    }
    ++audit.objects;
    audit.bytes += bytes;
    return Status::Ok();
  }));
  return audit;
}

Status SetAside(const std::filesystem::path& directory, const std::vector<std::string>& damaged, FileSystem& files) {
  DRUPE_RETURN_IF_ERROR(files.CreateDirectory(directory / "damaged"));
  for (const std::string& digest : damaged) {
    const std::filesystem::path folder = directory / digest.substr(0, 2);
    DRUPE_RETURN_IF_ERROR(files.Rename(folder / digest, directory / "damaged" / digest));
    DRUPE_RETURN_IF_ERROR(files.SyncDirectory(folder));
  }
  return files.SyncDirectory(directory / "damaged");
}

Result<GarbageReport> CollectGarbage(const std::filesystem::path& directory, std::set<std::string> roots,
                                     const GarbageOptions& options, FileSystem& files) {
  using Objects = std::map<std::string, FileInfo>;
  DRUPE_ASSIGN_OR_RETURN(const Objects objects, ListObjects(directory, files));
  for (const auto& [digest, info] : objects) {
    if (info.modified_ns >= options.unused_since_ns) roots.insert(digest);
  }
  DRUPE_RETURN_IF_ERROR(KeepWhatIsReached(directory, objects, roots, files));
  GarbageReport report;
  for (const auto& [digest, info] : objects) {
    bool keep = roots.contains(digest);
    if (!keep && !options.dry_run) {
      DRUPE_ASSIGN_OR_RETURN(const bool removed, RemoveUnlessRenewed(directory, digest, info, files));
      keep = !removed;
    }
    ++(keep ? report.kept : report.removed);
    (keep ? report.kept_bytes : report.removed_bytes) += info.size;
  }
  return report;
}

}  // namespace drupe
