#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "base/run_context.h"
#include "capture/camera/steady_camera.h"
#include "capture/rig_state.h"
#include "capture/scan/frame_check.h"
#include "capture/scan_request.h"
#include "capture/scan_store.h"
#include "capture/turntable/grbl_turntable.h"
#include "store/object_store.h"

namespace drupe {

/// What a scan works with; everything outlives it.
struct ScanTools {
  ObjectStore& objects;
  ScanStore& scans;
  RigState& rig;
  GrblOptions grbl;                ///< where the turntable is; an empty device: there is none
  SteadyCameraOptions patience;    ///< with a camera that is away
  std::function<void()> on_frame;  ///< a frame has been stored, for the hand-over; may be empty
};

/// One attempt at a scan: takes the views that are missing and stores each as it comes, so that an attempt after a
/// fault or in another process goes on where this one ended.
class ScanRun {
 public:
  ScanRun(const ScanTools& tools, std::string id, const ScanRequest& request, const RunContext& context);
  ~ScanRun();

  /// Returns once every view is stored. Stops the table however it ends. Errors: those of Turntable and SteadyCamera,
  /// 422 `calibration_size_mismatch`, `calibration_camera_mismatch`, `calibration_lens_mismatch`, 503 `views_missing`,
  /// `cancelled`.
  Status Run();

 private:
  Status Load();
  Status OpenCamera();
  Status OpenTable();
  Status TakeViews();

  /// Step mode.
  Status TakeStepwise();
  Status TakeView(int view);

  /// Continuous mode.
  Status TakeTurning();
  Status Sweep();
  Status WatchTurn(double end_deg);
  double AngleByPulses(const RawFrame& frame);
  Status TakeTurningFrame(const RawFrame& frame, double angle_deg);

  /// Develops, checks and shows a frame.
  struct Picture;
  Result<Picture> Develop(const RawFrame& frame, double motion_px, bool turned);
  Status Keep(int view, double angle_deg, const Picture& picture, int attempts);
  Status NoteStored();
  Status SaveCounters();
  double PixelsOfTurn(double degrees) const;

  const ScanTools& tools_;
  const std::string id_;
  const ScanRequest request_;
  const RunContext& context_;
  SteadyCamera camera_;
  std::unique_ptr<Turntable> table_;
  FrameInspector inspector_;
  struct Pulse {
    std::chrono::steady_clock::time_point exposed;
    double angle_deg;
  };
  std::optional<Pulse> last_pulse_;  ///< of a table that says nothing
  std::set<int> missing_;
  std::optional<double> phase_deg_;  ///< of the first view's angle from its nominal one, when pulses are not at 0
};

}  // namespace drupe
