#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/limits.h"
#include "base/run_context.h"
#include "base/status.h"
#include "capture/calibration/checkerboard.h"
#include "capture/calibration/corner_finder.h"
#include "capture/calibration/coverage.h"
#include "capture/calibration/zhang.h"
#include "scene/calibration.h"

namespace drupe {

/// A picture of the pattern. Bytes are read when they are needed, more than once, so that a set need not fit in memory.
struct PatternPicture {
  std::string name;
  std::function<Result<std::string>()> read;  ///< thread-safe
};

struct CalibrationOptions {
  CornerFinderOptions finder;
  /// Times that corners are measured again with the camera found so far, 0..5.
  int refinements = 2;
  /// A picture is dropped when its RMS is more than this times the median of all (a bent or misread pattern).
  double max_rms_ratio = 3;
  Limits limits;

  Status Check() const;
};

/// What became of one picture.
struct PictureReport {
  std::string name;
  bool used = false;
  std::string reason;   ///< why it was not used; empty when it was
  int corners = 0;      ///< measured in it
  double rms_px = 0;    ///< 0 when it was not used
  double tilt_deg = 0;  ///< between the pattern's normal and the line of sight to its middle
};

enum class CalibrationGrade { kGood, kUsable, kPoor };
const char* CalibrationGradeName(CalibrationGrade grade);  ///< "good", "usable", "poor"

/// A calibration with what is needed to trust it.
struct CalibrationResult {
  Calibration calibration;
  IntrinsicsSigma sigma;
  bool square_pixels = false;           ///< fx = fy was assumed
  bool fixed_k3 = false;                ///< k3 = 0 was assumed
  std::vector<PictureReport> pictures;  ///< in the order given
  CoverageMap coverage;                 ///< of the pictures in use
  CalibrationGrade grade = CalibrationGrade::kPoor;
  std::string verdict;  ///< in words: what is good about it, and what to do better
};

/// Calibrates a camera from pictures of a checkerboard or ChArUco board. Reports the stages "corners" and
/// "calibration". Pictures that are broken, of another size than most, or without the whole pattern are left out and
/// named in the report. Errors: 422 `too_few_pattern_pictures` (fewer than 3 can be used; the message says what became
/// of the others), 422 `calibration_failed`, `cancelled`.
Result<CalibrationResult> RunCalibration(const std::vector<PatternPicture>& pictures, const Checkerboard& pattern,
                                         const CalibrationOptions& options, const RunContext& context);

/// The report: {"calibration", "sigma", "assumed", "pictures", "coverage_pct", "coverage", "grade",
/// "verdict"}.
Json ToJson(const CalibrationResult& result);

}  // namespace drupe
