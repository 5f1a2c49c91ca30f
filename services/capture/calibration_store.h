#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "base/json.h"
#include "base/status.h"
#include "capture/camera_binding.h"
#include "jobs/sql/database.h"

namespace drupe {

/// A calibration that has been made.
struct StoredCalibration {
  std::string id;               ///< CalibrationId of the rest: the same calibration has the same id wherever it is made
  std::string job;              ///< that made it
  Json calibration;             ///< calibration.json
  CameraBinding binding;        ///< what it was made with
  std::string coverage_sha256;  ///< of the picture of the sensor, an object
};

/// "cal_" and the first 32 hexadecimal digits of the SHA-256 of calibration and binding.
std::string CalibrationId(const Json& calibration, const CameraBinding& binding);

/// The calibrations of a rig, named by their content; they outlive the jobs that made them. Thread-safe.
class CalibrationStore {
 public:
  /// `database` must outlive the store.
  static Result<std::unique_ptr<CalibrationStore>> Open(Database& database);

  /// Keeps a calibration; one that is there already stays as it is.
  Status Put(const StoredCalibration& calibration);
  /// By its id, or by that of the job. Errors: 404 `calibration_not_found`.
  Result<StoredCalibration> Get(std::string_view id);

 private:
  explicit CalibrationStore(Database& database) : database_(database) {}

  Database& database_;
};

}  // namespace drupe
