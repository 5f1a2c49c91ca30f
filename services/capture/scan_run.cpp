#include "capture/scan_run.h"

#include <numbers>

#include "base/clock.h"
#include "base/log.h"
#include "capture/scan/picture_name.h"
#include "capture/scan/small_picture.h"
#include "capture/scan_picture.h"
#include "capture/turntable/external_turntable.h"
#include "scene/calibration.h"

namespace drupe {
namespace {

using std::chrono::milliseconds;

constexpr int kPreviewWidth = 640;
constexpr int kPreviewQuality = 80;
constexpr int kShotTries = 20;

/// The table is at rest for whoever comes next, and nobody can stop it any more through this scan.
class TableGuard {
 public:
  TableGuard(RigState& rig, Turntable& table) : rig_(rig), table_(table) { rig_.SetTable(&table); }
  ~TableGuard() {
    rig_.SetTable(nullptr);
    const Result<TableReading> reading = table_.Read();
    if (!table_.can_position() || (reading.ok() && !reading->moving)) return;
    if (const Status stopped = table_.Stop(); !stopped.ok()) {
      Log(LogLevel::kError, "the table could not be stopped", {{"error", stopped.ToString()}});
      table_.EmergencyStop();
    }
  }
  TableGuard(const TableGuard&) = delete;
  TableGuard& operator=(const TableGuard&) = delete;

 private:
  RigState& rig_;
  Turntable& table_;
};

}  // namespace

ScanRun::ScanRun(const ScanTools& tools, std::string id, const ScanRequest& request, const RunContext& context)
    : tools_(tools),
      id_(std::move(id)),
      request_(request),
      context_(context),
      camera_(request.camera_id, request.camera, tools.patience, [this] { return context_.IsCancelled(); }),
      inspector_(request.checks) {}

ScanRun::~ScanRun() = default;

Status ScanRun::Run() {
  DRUPE_RETURN_IF_ERROR(tools_.scans.Begin(id_));
  DRUPE_RETURN_IF_ERROR(Load());
  if (missing_.empty()) return NoteStored();
  const Status taken = TakeViews();
  if (const Status saved = SaveCounters(); !saved.ok()) {
    Log(LogLevel::kWarning, "a scan's counters are lost", {{"scan", id_}, {"error", saved.ToString()}});
  }
  return taken;
}

/// The hand-over goes on at once: after the last view nothing waits until the table rests.
Status ScanRun::NoteStored() {
  if (missing_.empty()) DRUPE_RETURN_IF_ERROR(tools_.scans.SetCaptured(id_));
  if (tools_.on_frame) tools_.on_frame();
  return Status::Ok();
}

Status ScanRun::Load() {
  for (int view = 0; view < request_.views; ++view) missing_.insert(view);
  DRUPE_ASSIGN_OR_RETURN(const std::vector<ScanFrame> frames, tools_.scans.Frames(id_));
  if (request_.table_turns_by_itself && static_cast<int>(frames.size()) < request_.views) {
    return tools_.scans.RemoveFrames(id_);  // such a table has no angle that a later turn could go on from
  }
  for (const ScanFrame& frame : frames) {
    missing_.erase(frame.view);
    inspector_.Remember(ParseFrameCheck(frame.check));
    if (!phase_deg_) phase_deg_ = frame.angle_deg - frame.view * request_.step_deg();
  }
  return Status::Ok();
}

Status ScanRun::TakeViews() {
  DRUPE_RETURN_IF_ERROR(OpenCamera());
  DRUPE_RETURN_IF_ERROR(OpenTable());
  const TableGuard guard(tools_.rig, *table_);
  DRUPE_ASSIGN_OR_RETURN(const ScanRecord record, tools_.scans.Get(id_));
  DRUPE_RETURN_IF_ERROR(table_->Prepare());
  if (record.origin_deg && !request_.table.home) {
    table_->set_origin_deg(*record.origin_deg);
  } else {
    DRUPE_RETURN_IF_ERROR(tools_.scans.SetOrigin(id_, table_->origin_deg()));
  }
  return request_.mode == ScanMode::kStep ? TakeStepwise() : TakeTurning();
}

Status ScanRun::OpenCamera() {
  DRUPE_RETURN_IF_ERROR(camera_.Ensure());
  DRUPE_RETURN_IF_ERROR(SaveCounters());
  if (request_.calibration.is_null()) return Status::Ok();
  DRUPE_RETURN_IF_ERROR(CheckBinding(request_.calibrated_for, {camera_.identity().serial, request_.lens}));
  DRUPE_ASSIGN_OR_RETURN(const Calibration calibration, ParseCalibration(request_.calibration));
  return CheckCalibrationSize(calibration, camera_.width(), camera_.height());
}

Status ScanRun::OpenTable() {
  if (request_.table_turns_by_itself) {
    table_ = std::make_unique<ExternalTurntable>();
    return Status::Ok();
  }
  if (tools_.grbl.device.empty()) {
    return Unprocessable("no_turntable", "this service has no turntable; start it with --turntable-device");
  }
  DRUPE_ASSIGN_OR_RETURN(table_, GrblTurntable::Open(tools_.grbl, request_.table));
  return Status::Ok();
}

Status ScanRun::SaveCounters() {
  const Json camera = {{"id", camera_.identity().id},
                       {"serial", camera_.identity().serial},
                       {"width", camera_.width()},
                       {"height", camera_.height()}};
  return tools_.scans.SetCamera(id_, camera, ToJson(camera_.counters()));
}

/// What a turn moves at the picture's edge, if the axis is seen in its middle.
double ScanRun::PixelsOfTurn(double degrees) const {
  return std::abs(degrees) * std::numbers::pi / 180 * camera_.width() / 2;
}

Result<ScanRun::Picture> ScanRun::Develop(const RawFrame& frame, double motion_px, bool turned) {
  const std::int64_t age_ms =
      std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - frame.exposed).count();
  Picture picture;
  picture.taken_ms = Clock::System().NowMs() - age_ms;
  DRUPE_ASSIGN_OR_RETURN(picture.image, DevelopFrame(frame));
  picture.check = inspector_.Inspect(picture.image, motion_px, turned);
  DRUPE_ASSIGN_OR_RETURN(std::string preview, EncodeJpeg(ShrinkTo(picture.image, kPreviewWidth), kPreviewQuality));
  tools_.rig.ShowPreview(id_, std::move(preview));
  return picture;
}

Status ScanRun::Keep(int view, double angle_deg, const Picture& picture, int attempts) {
  DRUPE_ASSIGN_OR_RETURN(const std::string jpeg, EncodeJpeg(picture.image, request_.jpeg_quality));
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, tools_.objects.Put(jpeg));
  ScanFrame frame;
  frame.view = view, frame.name = PictureName(view), frame.sha256 = object.sha256;
  frame.bytes = static_cast<std::int64_t>(object.bytes);
  frame.width = picture.image.width(), frame.height = picture.image.height();
  frame.angle_deg = angle_deg, frame.taken_ms = picture.taken_ms, frame.attempts = attempts;
  frame.check = ToJson(picture.check);
  DRUPE_RETURN_IF_ERROR(tools_.scans.AddFrame(id_, frame).status());
  inspector_.Remember(picture.check);
  missing_.erase(view);
  context_.Report("capture", 1 - static_cast<double>(missing_.size()) / request_.views);
  return NoteStored();
}

Status ScanRun::TakeStepwise() {
  while (!missing_.empty()) {
    DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
    DRUPE_RETURN_IF_ERROR(TakeView(*missing_.begin()));
  }
  return Status::Ok();
}

Status ScanRun::TakeView(int view) {
  const double angle = view * request_.step_deg();
  for (int attempt = 1;; ++attempt) {
    DRUPE_RETURN_IF_ERROR(table_->MoveTo(angle, [this] { return context_.IsCancelled(); }));
    DRUPE_ASSIGN_OR_RETURN(const RawFrame frame, camera_.ShootPatiently(kShotTries));
    DRUPE_ASSIGN_OR_RETURN(const TableReading reading, table_->Read());
    DRUPE_ASSIGN_OR_RETURN(const Picture picture,
                           Develop(frame, PixelsOfTurn(reading.angle_deg - angle), attempt == 1));
    if (picture.check.ok() || attempt > request_.retakes) return Keep(view, reading.angle_deg, picture, attempt);
    Log(LogLevel::kInfo, "a frame is retaken", {{"scan", id_}, {"view", view}, {"faults", picture.check.faults}});
  }
}

}  // namespace drupe
