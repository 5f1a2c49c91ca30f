#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"

namespace drupe {

/// A camera that answered a search.
struct CameraInfo {
  std::string id;  ///< opens it: vendor, model and serial number as Aravis joins them
  std::string model;
  std::string serial;
  std::string vendor;
  std::string address;   ///< IP address, or the USB bus number
  std::string protocol;  ///< "GigEVision", "USB3Vision"
};

/// How the cameras are searched.
struct CameraSearchOptions {
  std::chrono::milliseconds max_age{2'000};   ///< an answer this young is given again
  std::chrono::milliseconds patience{5'000};  ///< how long List waits; a search without any camera takes about 1 s
};

/// The cameras on this machine's networks and USB ports, through Aravis. Searching is slow and Aravis keeps one list
/// for the process, so one search runs at a time, on a thread of its own, and everybody who asks meanwhile shares its
/// answer. Thread-safe.
class CameraDirectory {
 public:
  explicit CameraDirectory(const CameraSearchOptions& options = {});
  ~CameraDirectory();
  CameraDirectory(const CameraDirectory&) = delete;
  CameraDirectory& operator=(const CameraDirectory&) = delete;

  /// Ascending by id; empty when there is no camera. Errors: 503 `camera_search_slow` when a driver or the network
  /// keeps the search longer than patience; it goes on, and a later call gets its answer.
  Result<std::vector<CameraInfo>> List();

 private:
  struct Search;
  const CameraSearchOptions options_;
  const std::shared_ptr<Search> search_;  ///< shared with the thread, which a hanging driver may keep for ever
};

}  // namespace drupe
