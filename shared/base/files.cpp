#include "base/files.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace drupe {

namespace {

/// Closes a file descriptor when it goes out of scope.
class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

Status WriteAll(int fd, std::string_view content, const std::filesystem::path& path) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      return StatusFromErrno(errno, "write", path);
    }
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(fd) != 0) return StatusFromErrno(errno, "fsync", path);
  return Status::Ok();
}

}  // namespace

Status StatusFromErrno(int error_number, std::string_view operation, const std::filesystem::path& path) {
  const std::string message = std::string(operation) + " " + path.string() + ": " + std::strerror(error_number);
  if (error_number == ENOENT) return NotFound("file_not_found", message);
  if (error_number == ENOSPC || error_number == EDQUOT) {
    return {StatusKind::kInsufficientStorage, "disk_full", message};
  }
  return Internal("write_failed", message);
}

Result<std::string> ReadFile(const std::filesystem::path& path, std::size_t max_bytes) {
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  std::error_code error;
  if (!stream || std::filesystem::is_directory(path, error)) {
    return NotFound("file_not_found", "cannot read " + path.string());
  }
  const auto size = static_cast<std::size_t>(stream.tellg());
  if (size > max_bytes) {
    return Status(StatusKind::kTooLarge, "file_too_large",
                  path.string() + " has " + std::to_string(size) + " bytes; the limit is " + std::to_string(max_bytes));
  }
  std::string content(size, '\0');
  stream.seekg(0);
  if (!stream.read(content.data(), static_cast<std::streamsize>(size))) {
    return Internal("read_failed", "cannot read " + path.string());
  }
  return content;
}

Status SyncDirectory(const std::filesystem::path& directory) {
  const FileDescriptor fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0) return StatusFromErrno(errno, "open", directory);
  if (::fsync(fd.get()) != 0) return StatusFromErrno(errno, "fsync", directory);
  return Status::Ok();
}

Status WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  static std::atomic<unsigned> counter{0};
  const std::filesystem::path temporary =
      path.string() + ".tmp." + std::to_string(::getpid()) + "." + std::to_string(counter++);
  Status written = [&]() -> Status {
    const FileDescriptor fd(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
    if (fd.get() < 0) return StatusFromErrno(errno, "create", temporary);
    return WriteAll(fd.get(), content, temporary);
  }();
  if (written.ok() && ::rename(temporary.c_str(), path.c_str()) != 0) {
    written = StatusFromErrno(errno, "rename", path);
  }
  if (!written.ok()) {
    ::unlink(temporary.c_str());
    return written;
  }
  return SyncDirectory(path.has_parent_path() ? path.parent_path() : std::filesystem::path("."));
}

}  // namespace drupe
