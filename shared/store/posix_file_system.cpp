#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "base/files.h"
#include "store/file_system.h"

namespace drupe {

namespace {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

/// Takes the writer's lock on an open file; `operation` is LOCK_EX, with LOCK_NB to give up at once. 0 or an errno.
int LockFile(int fd, int operation) {
  while (::flock(fd, operation) != 0) {
    if (errno != EINTR) return errno;
  }
  return 0;
}

class PosixWritableFile : public WritableFile {
 public:
  PosixWritableFile(Descriptor fd, std::filesystem::path path) : fd_(std::move(fd)), path_(std::move(path)) {}

  Status Append(std::span<const std::byte> bytes) override {
    while (!bytes.empty()) {
      const ssize_t written = ::write(fd_.get(), bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return StatusFromErrno(errno, "write", path_);
      bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return Status::Ok();
  }

  Status Sync() override { return ::fsync(fd_.get()) == 0 ? Status::Ok() : StatusFromErrno(errno, "fsync", path_); }

 private:
  Descriptor fd_;
  std::filesystem::path path_;
};

class PosixPathLock : public PathLock {
 public:
  explicit PosixPathLock(Descriptor fd) : fd_(std::move(fd)) {}

 private:
  Descriptor fd_;  ///< the lock goes with it
};

class PosixReadableFile : public ReadableFile {
 public:
  PosixReadableFile(Descriptor fd, std::filesystem::path path) : fd_(std::move(fd)), path_(std::move(path)) {}

  Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> buffer) const override {
    std::size_t done = 0;
    while (done < buffer.size()) {
      const ssize_t count =
          ::pread(fd_.get(), buffer.data() + done, buffer.size() - done, static_cast<off_t>(offset + done));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return StatusFromErrno(errno, "read", path_);
      if (count == 0) break;
      done += static_cast<std::size_t>(count);
    }
    return done;
  }

  Result<FileInfo> Info() const override {
    struct stat info {};
    if (::fstat(fd_.get(), &info) != 0) return StatusFromErrno(errno, "stat", path_);
    return FileInfo{.size = static_cast<std::uint64_t>(info.st_size),
                    .modified_ns = std::int64_t{info.st_mtim.tv_sec} * 1'000'000'000 + info.st_mtim.tv_nsec,
                    .inode = info.st_ino};
  }

 private:
  Descriptor fd_;
  std::filesystem::path path_;
};

class PosixFileSystem : public FileSystem {
 public:
  Result<std::unique_ptr<WritableFile>> Create(const std::filesystem::path& path) override {
    for (;;) {
      Descriptor fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644));
      if (fd.get() < 0) return StatusFromErrno(errno, "create", path);
      if (const int error = LockFile(fd.get(), LOCK_EX)) return StatusFromErrno(error, "lock", path);
      // A sweep of another process may have removed the file between open and lock.
      struct stat info {};
      if (::fstat(fd.get(), &info) != 0) return StatusFromErrno(errno, "stat", path);
      if (info.st_nlink > 0) return std::unique_ptr<WritableFile>(new PosixWritableFile(std::move(fd), path));
    }
  }

  Result<std::unique_ptr<WritableFile>> OpenToAppend(const std::filesystem::path& path) override {
    for (;;) {
      Descriptor fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0644));
      if (fd.get() < 0) return StatusFromErrno(errno, "open", path);
      const int error = LockFile(fd.get(), LOCK_EX | LOCK_NB);
      if (error == EWOULDBLOCK)
        return Status(StatusKind::kConflict, "upload_in_progress", "this object is being sent by another client");
      if (error != 0) return StatusFromErrno(error, "lock", path);
      // Its former writer may have made an object of it between open and lock.
      struct stat info {
      }, named{};
      if (::fstat(fd.get(), &info) != 0) return StatusFromErrno(errno, "stat", path);
      if (::lstat(path.c_str(), &named) == 0 && named.st_ino == info.st_ino) {
        return std::unique_ptr<WritableFile>(new PosixWritableFile(std::move(fd), path));
      }
    }
  }

  Result<std::unique_ptr<ReadableFile>> Open(const std::filesystem::path& path) override {
    Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (fd.get() < 0) return StatusFromErrno(errno, "open", path);
    return std::unique_ptr<ReadableFile>(new PosixReadableFile(std::move(fd), path));
  }

  Status CreateDirectory(const std::filesystem::path& path) override {
    if (::mkdir(path.c_str(), 0755) == 0) return Status::Ok();
    const int error = errno;
    std::error_code ignored;
    if (error == EEXIST && std::filesystem::is_directory(path, ignored)) return Status::Ok();
    return StatusFromErrno(error, "mkdir", path);
  }

  Status Rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    return ::rename(from.c_str(), to.c_str()) == 0 ? Status::Ok() : StatusFromErrno(errno, "rename", to);
  }

  Status Remove(const std::filesystem::path& path) override {
    return ::unlink(path.c_str()) == 0 ? Status::Ok() : StatusFromErrno(errno, "remove", path);
  }

  Result<bool> RemoveIfAbandoned(const std::filesystem::path& path) override {
    const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
    if (fd.get() < 0 && errno == ENOENT) return false;
    if (fd.get() < 0) return StatusFromErrno(errno, "open", path);
    const int error = LockFile(fd.get(), LOCK_EX | LOCK_NB);
    if (error == EWOULDBLOCK) return false;
    if (error != 0) return StatusFromErrno(error, "lock", path);
    if (::unlink(path.c_str()) == 0) return true;
    // Gone: its writer renamed it between open and lock.
    return errno == ENOENT ? Result<bool>(false) : Result<bool>(StatusFromErrno(errno, "remove", path));
  }

  Status Touch(const std::filesystem::path& path) override {
    return ::utimensat(AT_FDCWD, path.c_str(), nullptr, AT_SYMLINK_NOFOLLOW) == 0
               ? Status::Ok()
               : StatusFromErrno(errno, "touch", path);
  }

  Result<std::unique_ptr<PathLock>> Lock(const std::filesystem::path& path, bool alone) override {
    Descriptor fd(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644));
    if (fd.get() < 0) return StatusFromErrno(errno, "open", path);
    if (const int error = LockFile(fd.get(), alone ? LOCK_EX : LOCK_SH)) return StatusFromErrno(error, "lock", path);
    return std::unique_ptr<PathLock>(new PosixPathLock(std::move(fd)));
  }

  Status SyncDirectory(const std::filesystem::path& path) override { return drupe::SyncDirectory(path); }

  Result<std::vector<std::string>> List(const std::filesystem::path& path) override {
    std::error_code error;
    std::vector<std::string> names;
    std::filesystem::directory_iterator entry(path, error);
    for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
      names.push_back(entry->path().filename().string());
    }
    if (error) return StatusFromErrno(error.value(), "list", path);
    return names;
  }

  Result<std::uint64_t> FreeBytes(const std::filesystem::path& path) override {
    struct statvfs info {};
    if (::statvfs(path.c_str(), &info) != 0) return StatusFromErrno(errno, "statvfs", path);
    return std::uint64_t{info.f_bavail} * info.f_frsize;
  }
};

}  // namespace

FileSystem& FileSystem::Posix() {
  static PosixFileSystem file_system;
  return file_system;
}

}  // namespace drupe
