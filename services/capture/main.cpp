#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/log.h"
#include "capture/calibration_job.h"
#include "capture/camera/camera_directory.h"
#include "capture/hand_over.h"
#include "capture/routes.h"
#include "capture/routes_scans.h"
#include "capture/routes_sessions.h"
#include "capture/scan_job.h"
#include "http/service.h"
#include "jobs/job_runner.h"
#include "service/service_stores.h"
#include "service/store_keeper.h"
#include "service/worker.h"

namespace drupe {
namespace {

/// What the user may set beyond the options of every service.
struct Settings {
  std::string reconstruction_url = "http://127.0.0.1:8082";
  std::string turntable_device;
  std::string turntable_axis = "A";
  int turntable_baud = 115200;
  int camera_patience_s = 60;
  JobRunnerOptions runner;

  Result<GrblOptions> Grbl() const {
    GrblOptions grbl{turntable_device, turntable_baud, turntable_axis.empty() ? ' ' : turntable_axis.front()};
    if (!turntable_device.empty()) DRUPE_RETURN_IF_ERROR(grbl.Check());
    return grbl;
  }
};

/// One scan at a time, since there is one rig. A drain does not wait for a turn to end: the next start goes on with it.
JobRunnerOptions ScanRunnerOptions() {
  JobRunnerOptions options;
  options.heartbeat_ms = 200;
  options.drain_ms = 500;
  options.worker_name = "rig";
  return options;
}

Status Serve(Service& service, const Settings& settings, int& exit_code) {
  const ServiceOptions& options = service.options();
  DRUPE_ASSIGN_OR_RETURN(ServiceStores stores, OpenServiceStores(options, "capture"));
  DRUPE_ASSIGN_OR_RETURN(const std::unique_ptr<ScanStore> scans, ScanStore::Open(*stores.database));
  DRUPE_ASSIGN_OR_RETURN(const std::unique_ptr<CalibrationStore> calibrations,
                         CalibrationStore::Open(*stores.database));
  DRUPE_ASSIGN_OR_RETURN(const std::unique_ptr<SessionStore> sessions, SessionStore::Open(*stores.database));
  DRUPE_ASSIGN_OR_RETURN(const GrblOptions grbl, settings.Grbl());
  DRUPE_ASSIGN_OR_RETURN(Client reconstruction, Client::Create(settings.reconstruction_url));
  CameraDirectory cameras;
  RigState rig;
  HandOver hand_over(*scans, *stores.jobs, *stores.objects, std::move(reconstruction), {});
  const SteadyCameraOptions patience{.patience = std::chrono::seconds(settings.camera_patience_s)};
  const ScanTools tools{*stores.objects, *scans, rig, grbl, patience, [&hand_over] { hand_over.Wake(); }};
  JobRunner scan_runner(*stores.jobs, ScanRunnerOptions());
  scan_runner.Handle(kScanKind, ScanJob(tools), {{"capture", 1}});
  JobRunnerOptions runner_options = settings.runner;
  runner_options.worker_name = WorkerName("calibrate");
  CountAttempts(service.metrics(), runner_options);
  JobRunner runner(*stores.jobs, runner_options);
  runner.Handle(kCalibrateKind, CalibrationJob(*stores.objects, *calibrations, options.limits), CalibrationStages());
  StoreKeeper keeper(stores, KeeperOptions(options, "capture", {}));  // scans and calibrations stay
  if (options.role != Role::kWorker) {
    const CaptureContext context{*stores.objects,
                                 *stores.jobs,
                                 cameras,
                                 *calibrations,
                                 options.limits,
                                 options.public_url,
                                 settings.reconstruction_url};
    AddCaptureRoutes(service.router(), context);
    AddScanRoutes(service.router(), {context, *scans, rig});
    AddSessionRoutes(service.router(), {context, *sessions, rig});
    AddStoreRoutes(service, stores);
    keeper.Start();
  }
  WatchStores(service, stores);
  service.OnDrain([&] {
    keeper.Stop();
    scan_runner.Stop();
    hand_over.Stop();
    runner.Stop();
  });
  if (options.role != Role::kApi) {
    DRUPE_RETURN_IF_ERROR(runner.Start());
    DRUPE_RETURN_IF_ERROR(scan_runner.Start());
    hand_over.Start();
  }
  exit_code = service.Run();
  return Status::Ok();
}

}  // namespace
}  // namespace drupe

int main(int argc, char** argv) {
  drupe::Service service("drupe-capture", 8081, "Runs the rig: finds cameras, calibrates them, scans on a turntable.");
  drupe::Settings settings;
  service.AddOption("--reconstruction-url", settings.reconstruction_url, "service that reconstructs what is scanned");
  service.AddOption("--turntable-device", settings.turntable_device,
                    "serial line of the turntable's GRBL controller, such as /dev/ttyUSB0; empty: none");
  service.AddOption("--turntable-axis", settings.turntable_axis, "axis of the controller that turns the table");
  service.AddOption("--turntable-baud", settings.turntable_baud, "speed of the serial line");
  service.AddOption("--camera-patience", settings.camera_patience_s,
                    "seconds that a scan waits for a camera that is away");
  service.AddOption("--workers", settings.runner.workers, "calibrations at once");
  service.AddOption("--threads", settings.runner.threads_per_job, "threads of a calibration, 0 for one per core");
  if (const std::optional<int> exit_code = service.Parse(argc, argv)) return *exit_code;
  int exit_code = 1;
  const drupe::Status served = drupe::Serve(service, settings, exit_code);
  if (!served.ok()) drupe::Log(drupe::LogLevel::kError, "cannot start", {{"error", served.ToString()}});
  return exit_code;
}
