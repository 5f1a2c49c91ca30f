#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "capture/calibration/guidance.h"
#include "capture/calibration_request.h"
#include "capture/camera/camera_options.h"
#include "jobs/sql/database.h"

namespace drupe {

/// A picture of a session that was kept.
struct SessionPicture {
  std::string name;
  std::string sha256;
  PatternCorners corners;
};

/// Pictures of the pattern being taken one by one, with advice on the next.
struct CalibrationSession {
  std::string id;
  CameraChoice camera;
  CameraBinding binding;  ///< the serial number once a picture has been taken
  Checkerboard pattern;
  int width = 0, height = 0;  ///< of the pictures; 0 before the first
  std::vector<SessionPicture> pictures;

  Guidance Guide() const;
  /// What the calibration is made from.
  CalibrationRequest Request() const;
};

/// Reads {"camera": id or options with "id", "pattern": pattern.json, "lens"}. Errors: 400 `invalid_option`,
/// `unknown_option`, `invalid_pattern`.
Result<CalibrationSession> ParseSession(const Json& json);
/// What a reply shows: {"id", "camera", "pattern", "width", "height", "images", "guidance"}.
Json ToJson(const CalibrationSession& session);

/// The sessions of a rig. Every change is durable when the call returns. Thread-safe.
class SessionStore {
 public:
  /// `database` must outlive the store.
  static Result<std::unique_ptr<SessionStore>> Open(Database& database);

  /// Adds a session or replaces its content.
  Status Put(const CalibrationSession& session);
  /// Errors: 404 `session_not_found`.
  Result<CalibrationSession> Get(std::string_view id);
  Status Remove(std::string_view id);

 private:
  explicit SessionStore(Database& database) : database_(database) {}

  Database& database_;
};

}  // namespace drupe
