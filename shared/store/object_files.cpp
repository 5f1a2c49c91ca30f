#include "store/object_files.h"

#include <algorithm>
#include <span>
#include <vector>

#include "base/digest.h"
#include "base/hex.h"

namespace drupe {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;

bool IsFanOut(const std::string& name) {
  return name.size() == 2 && IsHexDigit(name[0]) && IsHexDigit(name[1]);
}

}  // namespace

Status ForEachFile(const std::filesystem::path& directory, FileSystem& files,
                   const std::function<Status(const std::string&, const std::string&)>& visit) {
  DRUPE_ASSIGN_OR_RETURN(std::vector<std::string> folders, files.List(directory));
  std::sort(folders.begin(), folders.end());
  for (const std::string& folder : folders) {
    if (!IsFanOut(folder)) continue;
    DRUPE_ASSIGN_OR_RETURN(std::vector<std::string> names, files.List(directory / folder));
    std::sort(names.begin(), names.end());
    for (const std::string& name : names) DRUPE_RETURN_IF_ERROR(visit(folder, name));
  }
  return Status::Ok();
}

Result<std::map<std::string, FileInfo>> ListObjects(const std::filesystem::path& directory, FileSystem& files) {
  std::map<std::string, FileInfo> objects;
  DRUPE_RETURN_IF_ERROR(ForEachFile(directory, files, [&](const std::string& folder, const std::string& name) {
    if (!IsSha256Hex(name) || !name.starts_with(folder)) return Status::Ok();
    const auto file = files.Open(directory / folder / name);
    if (!file.ok()) return file.status().kind() == StatusKind::kNotFound ? Status::Ok() : file.status();
    const Result<FileInfo> info = (*file)->Info();
    if (!info.ok()) return info.status();
    objects[name] = *info;
    return Status::Ok();
  }));
  return objects;
}

Status ReadAll(const ReadableFile& file, const std::function<void(std::string_view)>& take) {
  std::string chunk(kChunk, '\0');
  for (std::uint64_t offset = 0;;) {
    DRUPE_ASSIGN_OR_RETURN(const std::size_t count, file.ReadAt(offset, std::as_writable_bytes(std::span(chunk))));
    take(std::string_view(chunk).substr(0, count));
    if (count < chunk.size()) return Status::Ok();
    offset += count;
  }
}

Result<std::string> DigestOf(const ReadableFile& file) {
  Sha256 digest;
  DRUPE_RETURN_IF_ERROR(ReadAll(file, [&](std::string_view piece) { digest.Update(piece); }));
  return digest.FinishHex();
}

}  // namespace drupe
