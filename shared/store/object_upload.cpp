#include "store/object_upload.h"

#include "store/disk_object_store.h"
#include "store/object_files.h"

namespace drupe {

Status ObjectUpload::Append(std::span<const std::byte> bytes) {
  if (bytes.size() > total_ - bytes_) {
    return {StatusKind::kTooLarge, "object_too_large",
            "more bytes than the " + std::to_string(total_) + " that were announced"};
  }
  DRUPE_RETURN_IF_ERROR(file_->Append(bytes));
  bytes_ += bytes.size();
  return Status::Ok();
}

// The digest is that of the file as it is now: what was written before a power cut may be zeros after it.
Result<ObjectInfo> ObjectUpload::Commit() {
  DRUPE_RETURN_IF_ERROR(file_->Sync());
  DRUPE_ASSIGN_OR_RETURN(const auto written, store_->file_system_.Open(path_));
  DRUPE_ASSIGN_OR_RETURN(const std::string digest, DigestOf(*written));
  if (digest != sha256_) {
    DRUPE_RETURN_IF_ERROR(store_->file_system_.Remove(path_));
    return Unprocessable("digest_mismatch", "the bytes have the digest " + digest + ", not " + sha256_);
  }
  ObjectInfo object{sha256_, bytes_};
  DRUPE_RETURN_IF_ERROR(store_->Publish(path_, object));
  return object;
}

std::filesystem::path DiskObjectStore::UploadPath(std::string_view sha256) const {
  return directory_ / kUploadFolder / sha256;
}

Result<std::uint64_t> DiskObjectStore::UploadedBytes(std::string_view sha256) const {
  DRUPE_RETURN_IF_ERROR(PathOf(sha256).status());
  const auto file = file_system_.Open(UploadPath(sha256));
  if (!file.ok()) return file.status().kind() == StatusKind::kNotFound ? Result<std::uint64_t>(0) : file.status();
  DRUPE_ASSIGN_OR_RETURN(const FileInfo info, (*file)->Info());
  return info.size;
}

Result<ObjectUpload> DiskObjectStore::ResumeUpload(std::string_view sha256, std::uint64_t offset, std::uint64_t total) {
  DRUPE_RETURN_IF_ERROR(PathOf(sha256).status());
  DRUPE_RETURN_IF_ERROR(CheckLength(total));
  DRUPE_RETURN_IF_ERROR(CheckWritable(total - std::min(offset, total)));
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<WritableFile> file, file_system_.OpenToAppend(UploadPath(sha256)));
  // Under the lock, so that nobody appends between the look and the first byte.
  DRUPE_ASSIGN_OR_RETURN(const std::uint64_t kept, UploadedBytes(sha256));
  if (kept != offset || kept > total) {
    return Status(
        StatusKind::kConflict, "upload_offset",
        std::to_string(kept) + " bytes of this object are kept, not " + std::to_string(offset) + "; go on there");
  }
  return ObjectUpload(*this, std::string(sha256), UploadPath(sha256), std::move(file), kept, total);
}

}  // namespace drupe
