#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "jobs/sql/database.h"

namespace drupe {

/// A frame of a scan; its JPEG is an object of the store.
struct ScanFrame {
  int view = 0;      ///< 0..views-1
  std::string name;  ///< "007.jpg"
  std::string sha256;
  std::int64_t bytes = 0;
  int width = 0, height = 0;
  double angle_deg = 0;  ///< of the table, measured
  std::int64_t taken_ms = 0;
  int attempts = 1;  ///< pictures taken of this view
  Json check;        ///< FrameCheck
  bool sent = false;
};

/// How far a scan and its hand-over are; survives the process.
struct ScanRecord {
  std::string id;
  std::optional<double> origin_deg;  ///< of the table, in its controller's count; absent before the table was prepared
  Json counters;                     ///< CameraCounters over all attempts
  Json camera;                       ///< {"id", "serial", "width", "height"} once opened
  bool captured = false;             ///< every view is there
  std::int64_t last_shutter_ms = 0;
  bool ended = false;           ///< nothing more is to be handed over
  std::string image_set;        ///< at the reconstruction service; empty before
  std::string job;              ///< reconstruction; empty before
  std::string hand_over_error;  ///< why the hand-over waits; empty when it does not
  Json timings;                 ///< seconds from the last shutter: {"sparse_s", "reconstruction_s", "report_s"}
};

/// The scans of a rig. Every change is durable when the call returns. Thread-safe.
class ScanStore {
 public:
  /// `database` must outlive the store.
  static Result<std::unique_ptr<ScanStore>> Open(Database& database);

  /// Makes the record of a scan unless there is one.
  Status Begin(std::string_view id);
  /// Errors: 404 `scan_not_found`.
  Result<ScanRecord> Get(std::string_view id);
  /// Ascending by view.
  Result<std::vector<ScanFrame>> Frames(std::string_view id);
  Status SetOrigin(std::string_view id, double origin_deg);
  Status SetCamera(std::string_view id, const Json& camera, const Json& counters);
  /// Adds a frame, unless the view has one already: then it stays, and false is returned.
  Result<bool> AddFrame(std::string_view id, const ScanFrame& frame);
  /// Forgets the frames: the scan begins anew.
  Status RemoveFrames(std::string_view id);
  Status SetCaptured(std::string_view id);

  /// Scans with something left to hand over, oldest first.
  Result<std::vector<std::string>> Unfinished();
  /// An empty set forgets what was sent: the service has lost it.
  Status SetImageSet(std::string_view id, std::string_view image_set);
  Status SetSent(std::string_view id, const ScanFrame& frame);
  Status SetJob(std::string_view id, std::string_view job);
  Status SetHandOverError(std::string_view id, std::string_view error);
  Status SetTimings(std::string_view id, const Json& timings);
  Status SetEnded(std::string_view id);
  /// The scan goes on, and so does its hand-over.
  Status Reopen(std::string_view id);

 private:
  explicit ScanStore(Database& database) : database_(database) {}
  /// Sets one column of a scan.
  template <typename Value>
  Status Set(const std::string& column, std::string_view id, const Value& value);

  Database& database_;
};

Json ToJson(const ScanFrame& frame);

}  // namespace drupe
