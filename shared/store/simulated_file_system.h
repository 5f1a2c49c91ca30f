#pragma once

#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "store/file_system.h"

namespace drupe {

/// For tests: a file system in memory that can fail or stop at its n-th changing call, and that forgets on a power cut
/// what was not synced: bytes of files without Sync, entries of directories without SyncDirectory.
class SimulatedFileSystem : public FileSystem {
 public:
  explicit SimulatedFileSystem(const std::filesystem::path& root) { live_[root] = durable_[root] = nullptr; }

  /// The n-th changing call from now, counted from 0, returns `error`; with `and_after`, all later ones too, as if the
  /// process had been killed before it.
  void FailAt(int n, Status error, bool and_after) {
    calls_until_failure_ = n;
    error_ = std::move(error);
    stay_failed_ = and_after;
  }
  /// No more failures. Returns whether one happened.
  bool Heal() {
    calls_until_failure_ = -1;
    return std::exchange(has_failed_, false);
  }
  /// The process and the machine die: locks go, and everything that was not synced.
  void PowerCut() {
    KillProcess();
    std::map<std::filesystem::path, Node> kept;
    for (const auto& [path, node] : durable_) {
      // Parents sort before their children, so a lost directory takes its content along.
      if (!kept.empty() && !kept.contains(path.parent_path())) continue;
      if (node) node->bytes = node->synced;
      kept[path] = node;
    }
    live_ = durable_ = kept;
  }
  /// The process dies: its locks go.
  void KillProcess() {
    for (auto& [path, node] : live_) {
      if (node) node->locked = false;
    }
  }
  void set_free_bytes(std::uint64_t bytes) { free_bytes_ = bytes; }
  int FileCount(const std::filesystem::path& directory) const {
    int count = 0;
    for (const auto& [path, node] : live_) count += node && path.parent_path() == directory ? 1 : 0;
    return count;
  }

  Result<std::unique_ptr<WritableFile>> Create(const std::filesystem::path& path) override {
    DRUPE_RETURN_IF_ERROR(Change());
    if (!live_.contains(path.parent_path()) || live_.contains(path)) return Internal("write_failed", "create");
    Node node = std::make_shared<Inode>();
    node->locked = true;
    live_[path] = node;
    return std::unique_ptr<WritableFile>(new Writer(*this, node));
  }
  Result<std::unique_ptr<WritableFile>> OpenToAppend(const std::filesystem::path& path) override {
    if (!live_.contains(path)) return Create(path);
    DRUPE_RETURN_IF_ERROR(Change());
    const Node node = live_[path];
    if (std::exchange(node->locked, true)) return Status(StatusKind::kConflict, "upload_in_progress", path.string());
    return std::unique_ptr<WritableFile>(new Writer(*this, node));
  }
  Result<std::unique_ptr<ReadableFile>> Open(const std::filesystem::path& path) override {
    const auto found = live_.find(path);
    if (found == live_.end() || !found->second) return NotFound("file_not_found", path.string());
    return std::unique_ptr<ReadableFile>(new Reader(found->second));
  }
  Status CreateDirectory(const std::filesystem::path& path) override {
    DRUPE_RETURN_IF_ERROR(Change());
    live_.try_emplace(path, nullptr);
    return Status::Ok();
  }
  Status Rename(const std::filesystem::path& from, const std::filesystem::path& to) override {
    DRUPE_RETURN_IF_ERROR(Change());
    if (!live_.contains(from)) return NotFound("file_not_found", from.string());
    live_[to] = live_[from];
    live_.erase(from);
    return Status::Ok();
  }
  Status Remove(const std::filesystem::path& path) override {
    DRUPE_RETURN_IF_ERROR(Change());
    return live_.erase(path) == 1 ? Status::Ok() : NotFound("file_not_found", path.string());
  }
  Result<bool> RemoveIfAbandoned(const std::filesystem::path& path) override {
    DRUPE_RETURN_IF_ERROR(Change());
    if (live_.at(path)->locked) return false;
    live_.erase(path);
    return true;
  }
  Status Touch(const std::filesystem::path& path) override {
    return live_.contains(path) ? Status::Ok() : NotFound("file_not_found", path.string());
  }
  Result<std::unique_ptr<PathLock>> Lock(const std::filesystem::path&, bool) override {
    return std::make_unique<PathLock>();
  }
  Status SyncDirectory(const std::filesystem::path& path) override {
    DRUPE_RETURN_IF_ERROR(Change());
    std::erase_if(durable_, [&](const auto& entry) {
      return entry.first.parent_path() == path && entry.first != path && !live_.contains(entry.first);
    });
    for (const auto& [name, node] : live_) {
      if (name.parent_path() == path && name != path) durable_[name] = node;
    }
    return Status::Ok();
  }
  Result<std::vector<std::string>> List(const std::filesystem::path& path) override {
    std::vector<std::string> names;
    for (const auto& [name, node] : live_) {
      if (name.parent_path() == path && name != path) names.push_back(name.filename().string());
    }
    return names;
  }
  Result<std::uint64_t> FreeBytes(const std::filesystem::path&) override { return free_bytes_; }

 private:
  struct Inode {
    std::string bytes, synced;
    bool locked = false;
  };
  using Node = std::shared_ptr<Inode>;  ///< null: a directory

  class Writer : public WritableFile {
   public:
    Writer(SimulatedFileSystem& system, Node node) : system_(system), node_(std::move(node)) {}
    ~Writer() override { node_->locked = false; }
    Status Append(std::span<const std::byte> bytes) override {
      DRUPE_RETURN_IF_ERROR(system_.Change());
      node_->bytes.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      return Status::Ok();
    }
    Status Sync() override {
      DRUPE_RETURN_IF_ERROR(system_.Change());
      node_->synced = node_->bytes;
      return Status::Ok();
    }

   private:
    SimulatedFileSystem& system_;
    Node node_;
  };

  class Reader : public ReadableFile {
   public:
    explicit Reader(Node node) : node_(std::move(node)) {}
    Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> buffer) const override {
      if (offset >= node_->bytes.size()) return std::size_t{0};
      const std::size_t count = std::min<std::size_t>(buffer.size(), node_->bytes.size() - offset);
      std::memcpy(buffer.data(), node_->bytes.data() + offset, count);
      return count;
    }
    Result<FileInfo> Info() const override {
      return FileInfo{.size = node_->bytes.size(), .inode = reinterpret_cast<std::uintptr_t>(node_.get())};
    }

   private:
    Node node_;
  };

  Status Change() {
    if (has_failed_ && stay_failed_ && calls_until_failure_ != -1) return error_;
    if (calls_until_failure_ < 0 || calls_until_failure_-- > 0) return Status::Ok();
    has_failed_ = true;
    if (stay_failed_) calls_until_failure_ = 0;
    return error_;
  }

  std::map<std::filesystem::path, Node> live_, durable_;
  int calls_until_failure_ = -1;  ///< -1: none to come
  bool stay_failed_ = false;
  bool has_failed_ = false;
  Status error_;
  std::uint64_t free_bytes_ = std::uint64_t{1} << 40;
};

}  // namespace drupe
