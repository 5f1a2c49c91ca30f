#include "store/disk_object_store.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/hex.h"
#include "base/ids.h"
#include "base/log.h"
#include "store/object_files.h"

namespace drupe {

namespace {

/// An upload that nobody has gone on with for so long is given up.
constexpr std::int64_t kForgottenUploadNs = std::int64_t{24} * 3600 * 1'000'000'000;

/// The 256 directories "00".."ff" that objects are spread over.
std::string FanOutName(unsigned byte) {
  return HexOf(std::array{static_cast<unsigned char>(byte)});
}

Status ObjectNotFound(std::string_view sha256) {
  return NotFound("object_not_found", "there is no object " + std::string(sha256));
}

Status ObjectDamaged(std::string_view sha256) {
  return {StatusKind::kDataLoss, "object_damaged",
          "the stored bytes of object " + std::string(sha256) + " do not have that digest"};
}

Status ObjectTooLarge(std::uint64_t bytes, std::uint64_t limit) {
  return {StatusKind::kTooLarge, "object_too_large",
          "an object of " + std::to_string(bytes) + " bytes; the limit is " + std::to_string(limit)};
}

}  // namespace

// ---- ObjectWriter

ObjectWriter::ObjectWriter(DiskObjectStore& store, std::filesystem::path temporary, std::unique_ptr<WritableFile> file)
    : store_(&store), temporary_(std::move(temporary)), file_(std::move(file)) {}

ObjectWriter::ObjectWriter(ObjectWriter&& other) noexcept
    : store_(other.store_),
      temporary_(std::exchange(other.temporary_, {})),
      file_(std::move(other.file_)),
      digest_(std::move(other.digest_)),
      bytes_(other.bytes_) {}

ObjectWriter::~ObjectWriter() {
  if (temporary_.empty()) return;
  const Status removed = store_->file_system_.Remove(temporary_);
  // Not fatal: the next start sweeps it.
  if (!removed.ok()) Log(LogLevel::kWarning, "temporary file not removed", {{"error", removed.ToString()}});
}

Status ObjectWriter::Append(std::span<const std::byte> bytes) {
  const std::uint64_t limit = store_->options_.max_object_bytes;
  if (bytes.size() > limit - bytes_) return ObjectTooLarge(bytes_ + bytes.size(), limit);
  DRUPE_RETURN_IF_ERROR(file_->Append(bytes));
  digest_.Update(bytes);
  bytes_ += bytes.size();
  return Status::Ok();
}

Status ObjectWriter::Append(std::string_view text) {
  return Append(std::as_bytes(std::span(text)));
}

Result<ObjectInfo> ObjectWriter::Commit() {
  DRUPE_RETURN_IF_ERROR(file_->Sync());
  ObjectInfo info{.sha256 = digest_.FinishHex(), .bytes = bytes_};
  DRUPE_RETURN_IF_ERROR(store_->Publish(temporary_, info));
  temporary_.clear();
  return info;
}

// ---- ObjectReader

Result<std::size_t> ObjectReader::ReadAt(std::uint64_t offset, std::span<std::byte> buffer) const {
  if (offset >= size_) return std::size_t{0};
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), size_ - offset));
  return file_->ReadAt(offset, buffer.first(wanted));
}

// ---- DiskObjectStore

DiskObjectStore::DiskObjectStore(std::filesystem::path directory, const ObjectStoreOptions& options,
                                 FileSystem& file_system)
    : directory_(std::move(directory)),
      options_(options),
      file_system_(file_system),
      usage_(directory_, file_system, options.max_total_bytes) {}

Result<std::unique_ptr<DiskObjectStore>> DiskObjectStore::Open(std::filesystem::path directory,
                                                               const ObjectStoreOptions& options,
                                                               FileSystem& file_system) {
  std::unique_ptr<DiskObjectStore> store(new DiskObjectStore(std::move(directory), options, file_system));
  DRUPE_RETURN_IF_ERROR(store->CreateDirectories());
  DRUPE_RETURN_IF_ERROR(store->SweepTemporaries());
  DRUPE_RETURN_IF_ERROR(store->SweepUploads());
  return store;
}

// All fan-out directories are made durable here, once, so that a Commit has only one directory to sync.
Status DiskObjectStore::CreateDirectories() {
  DRUPE_RETURN_IF_ERROR(file_system_.CreateDirectory(directory_));
  for (const std::string_view folder : {kTemporaryFolder, kUploadFolder, kRootsFolder}) {
    DRUPE_RETURN_IF_ERROR(file_system_.CreateDirectory(directory_ / folder));
  }
  for (unsigned byte = 0; byte < 256; ++byte) {
    DRUPE_RETURN_IF_ERROR(file_system_.CreateDirectory(directory_ / FanOutName(byte)));
  }
  DRUPE_RETURN_IF_ERROR(file_system_.SyncDirectory(directory_));
  return file_system_.SyncDirectory(directory_.has_parent_path() ? directory_.parent_path() : ".");
}

Status DiskObjectStore::SweepTemporaries() {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<std::string> names, file_system_.List(directory_ / kTemporaryFolder));
  int swept = 0;
  for (const std::string& name : names) {
    DRUPE_ASSIGN_OR_RETURN(const bool removed, file_system_.RemoveIfAbandoned(directory_ / kTemporaryFolder / name));
    swept += removed ? 1 : 0;
  }
  if (swept > 0) Log(LogLevel::kInfo, "swept temporary files", {{"count", swept}});
  return Status::Ok();
}

Status DiskObjectStore::SweepUploads() {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<std::string> names, file_system_.List(directory_ / kUploadFolder));
  const std::int64_t oldest_ns = Clock::System().NowMs() * 1'000'000 - kForgottenUploadNs;
  for (const std::string& name : names) {
    const auto file = file_system_.Open(directory_ / kUploadFolder / name);
    if (!file.ok() && file.status().kind() == StatusKind::kNotFound) continue;  // another process has just finished it
    DRUPE_RETURN_IF_ERROR(file.status());
    DRUPE_ASSIGN_OR_RETURN(const FileInfo info, (*file)->Info());
    if (info.modified_ns >= oldest_ns) continue;
    DRUPE_RETURN_IF_ERROR(file_system_.RemoveIfAbandoned(directory_ / kUploadFolder / name).status());
  }
  return Status::Ok();
}

Result<ObjectInfo> DiskObjectStore::Put(std::string_view bytes) {
  DRUPE_ASSIGN_OR_RETURN(ObjectWriter writer, Begin(bytes.size()));
  DRUPE_RETURN_IF_ERROR(writer.Append(bytes));
  return writer.Commit();
}

Result<ObjectWriter> DiskObjectStore::Begin(std::uint64_t expected_bytes) {
  DRUPE_RETURN_IF_ERROR(CheckLength(expected_bytes));
  DRUPE_RETURN_IF_ERROR(CheckWritable(expected_bytes));
  std::filesystem::path temporary = directory_ / kTemporaryFolder / NewId("tmp");
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<WritableFile> file, file_system_.Create(temporary));
  return ObjectWriter(*this, std::move(temporary), std::move(file));
}

// An existing object of that name is replaced rather than kept: the bytes are the same, unless the old copy is damaged.
Status DiskObjectStore::Publish(const std::filesystem::path& temporary, const ObjectInfo& object) {
  DRUPE_ASSIGN_OR_RETURN(const std::filesystem::path path, PathOf(object.sha256));
  {
    DRUPE_ASSIGN_OR_RETURN(const auto lock, file_system_.Lock(directory_ / kCollectionLock, false));
    DRUPE_RETURN_IF_ERROR(file_system_.Rename(temporary, path));
  }
  usage_.Add(object.bytes);
  return file_system_.SyncDirectory(path.parent_path());
}

Result<std::filesystem::path> DiskObjectStore::PathOf(std::string_view sha256) const {
  if (!IsSha256Hex(sha256)) {
    return InvalidArgument("invalid_digest", "an object is named by 64 lower-case hexadecimal digits");
  }
  return directory_ / sha256.substr(0, 2) / sha256;
}

Result<std::unique_ptr<ReadableFile>> DiskObjectStore::OpenFile(std::string_view sha256) const {
  DRUPE_ASSIGN_OR_RETURN(const std::filesystem::path path, PathOf(sha256));
  auto file = file_system_.Open(path);
  if (!file.ok() && file.status().kind() == StatusKind::kNotFound) return ObjectNotFound(sha256);
  return file;
}

Result<std::string> DiskObjectStore::Get(std::string_view sha256, std::uint64_t max_bytes) {
  DRUPE_ASSIGN_OR_RETURN(const std::unique_ptr<ReadableFile> file, OpenFile(sha256));
  DRUPE_ASSIGN_OR_RETURN(const FileInfo info, file->Info());
  if (info.size > max_bytes) return ObjectTooLarge(info.size, max_bytes);
  std::string content(info.size, '\0');
  DRUPE_ASSIGN_OR_RETURN(const std::size_t count, file->ReadAt(0, std::as_writable_bytes(std::span(content))));
  if (count != content.size() || Sha256Hex(content) != sha256) return ObjectDamaged(sha256);
  return content;
}

Result<std::unique_ptr<ObjectReader>> DiskObjectStore::OpenObject(std::string_view sha256) {
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<ReadableFile> file, OpenFile(sha256));
  DRUPE_ASSIGN_OR_RETURN(const FileInfo info, file->Info());
  DRUPE_RETURN_IF_ERROR(CheckDigestOnce(std::string(sha256), *file, info));
  return std::unique_ptr<ObjectReader>(new ObjectReader(std::move(file), info.size));
}

Status DiskObjectStore::CheckDigestOnce(const std::string& sha256, const ReadableFile& file, const FileInfo& info) {
  {
    const std::lock_guard lock(verified_mutex_);
    const auto known = verified_.find(sha256);
    if (known != verified_.end() && known->second == info) return Status::Ok();
  }
  DRUPE_ASSIGN_OR_RETURN(const std::string digest, DigestOf(file));
  if (digest != sha256) return ObjectDamaged(sha256);
  const std::lock_guard lock(verified_mutex_);
  verified_[sha256] = info;
  return Status::Ok();
}

Result<bool> DiskObjectStore::Renew(std::string_view sha256) {
  DRUPE_ASSIGN_OR_RETURN(const std::filesystem::path path, PathOf(sha256));
  DRUPE_ASSIGN_OR_RETURN(const auto lock, file_system_.Lock(directory_ / kCollectionLock, false));
  const Status touched = file_system_.Touch(path);
  if (!touched.ok() && touched.kind() == StatusKind::kNotFound) return false;
  DRUPE_RETURN_IF_ERROR(touched);
  return true;
}

Result<std::uint64_t> DiskObjectStore::Size(std::string_view sha256) {
  DRUPE_ASSIGN_OR_RETURN(const std::unique_ptr<ReadableFile> file, OpenFile(sha256));
  DRUPE_ASSIGN_OR_RETURN(const FileInfo info, file->Info());
  return info.size;
}

Status DiskObjectStore::Remove(std::string_view sha256) {
  DRUPE_ASSIGN_OR_RETURN(const std::filesystem::path path, PathOf(sha256));
  const Status removed = file_system_.Remove(path);
  if (!removed.ok() && removed.kind() != StatusKind::kNotFound) return removed;
  {
    const std::lock_guard lock(verified_mutex_);
    verified_.erase(std::string(sha256));
  }
  return file_system_.SyncDirectory(path.parent_path());
}

Status DiskObjectStore::CheckLength(std::uint64_t bytes) const {
  if (bytes <= options_.max_object_bytes) return Status::Ok();
  return ObjectTooLarge(bytes, options_.max_object_bytes);
}

Status DiskObjectStore::CheckWritable(std::uint64_t expected_bytes) {
  DRUPE_ASSIGN_OR_RETURN(const std::uint64_t free_bytes, file_system_.FreeBytes(directory_));
  if (free_bytes >= options_.min_free_bytes && free_bytes - options_.min_free_bytes >= expected_bytes) {
    return usage_.Admit(expected_bytes);
  }
  return {StatusKind::kInsufficientStorage, "disk_full",
          "the object store has " + std::to_string(free_bytes) + " bytes free and keeps " +
              std::to_string(options_.min_free_bytes) + " in reserve"};
}

}  // namespace drupe
