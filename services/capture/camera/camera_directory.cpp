#include "capture/camera/camera_directory.h"

#include <condition_variable>
#include <mutex>
#include <thread>

#include "capture/camera/aravis_search.h"

namespace drupe {

using SteadyClock = std::chrono::steady_clock;

/// The state of the search under way and the answer of the last one.
struct CameraDirectory::Search {
  std::mutex mutex;
  std::condition_variable ended;
  bool running = false;
  bool has_answer = false;
  SteadyClock::time_point answered_at;
  std::vector<CameraInfo> cameras;

  bool IsFresh(std::chrono::milliseconds max_age) const {
    return has_answer && SteadyClock::now() - answered_at <= max_age;
  }

  void Finish(std::vector<CameraInfo> found) {
    const std::lock_guard lock(mutex);
    cameras = std::move(found);
    answered_at = SteadyClock::now();
    has_answer = true;
    running = false;
    ended.notify_all();
  }
};

CameraDirectory::CameraDirectory(const CameraSearchOptions& options)
    : options_(options), search_(std::make_shared<Search>()) {}

CameraDirectory::~CameraDirectory() {
  std::unique_lock lock(search_->mutex);  // Aravis should not be at work while the process exits
  search_->ended.wait_for(lock, options_.patience, [this] { return !search_->running; });
}

Result<std::vector<CameraInfo>> CameraDirectory::List() {
  std::unique_lock lock(search_->mutex);
  if (!search_->running && search_->IsFresh(options_.max_age)) return search_->cameras;
  if (!search_->running) {
    search_->running = true;
    std::thread([search = search_] { search->Finish(SearchWithAravis()); }).detach();
  }
  if (!search_->ended.wait_for(lock, options_.patience, [this] { return !search_->running; })) {
    return Status(StatusKind::kUnavailable, "camera_search_slow",
                  "the search for cameras has not ended yet; ask again");
  }
  return search_->cameras;
}

}  // namespace drupe
