#include <memory>
#include <optional>
#include <string>

#include "base/log.h"
#include "capture/calibration_job.h"
#include "capture/camera/camera_directory.h"
#include "capture/routes.h"
#include "http/service.h"
#include "jobs/job_runner.h"
#include "jobs/sql/sql_job_store.h"
#include "jobs/sqlite/database.h"
#include "store/object_store.h"

namespace drupe {
namespace {

/// What the user may set beyond the options of every service.
struct Settings {
  std::string reconstruction_url = "http://127.0.0.1:8082";
  JobRunnerOptions runner;
};

/// The stores of the service, in the order in which they depend on one another.
struct Stores {
  std::unique_ptr<ObjectStore> objects;
  std::unique_ptr<SqliteDatabase> database;
  std::unique_ptr<JobStore> jobs;
};

Result<Stores> OpenStores(const ServiceOptions& options) {
  Stores stores;
  DRUPE_ASSIGN_OR_RETURN(stores.objects, ObjectStore::Open(options.data / "objects"));
  DRUPE_ASSIGN_OR_RETURN(stores.database, SqliteDatabase::Open(options.data / "capture.db"));
  DRUPE_ASSIGN_OR_RETURN(stores.jobs, OpenJobStore(*stores.database));
  return stores;
}

void WatchStores(Service& service, const Stores& stores) {
  JobStore& jobs = *stores.jobs;
  ObjectStore& objects = *stores.objects;
  service.AddReadinessCheck("jobs", [&jobs] { return jobs.Counts().status(); });
  service.AddReadinessCheck("objects", [&objects] { return objects.CheckWritable(); });
  const auto gauge = [&](const char* name, const char* help, std::int64_t JobCounts::*count) {
    service.metrics().AddGauge(name, help, [&jobs, count] {
      const Result<JobCounts> counts = jobs.Counts();
      return counts.ok() ? static_cast<double>((*counts).*count) : -1.0;
    });
  };
  gauge("drupe_jobs_queued", "Jobs that wait", &JobCounts::queued);
  gauge("drupe_jobs_running", "Jobs that run", &JobCounts::running);
  gauge("drupe_jobs_failed", "Jobs that have failed for good", &JobCounts::failed);
}

Status Serve(Service& service, const Settings& settings, int& exit_code) {
  const ServiceOptions& options = service.options();
  DRUPE_ASSIGN_OR_RETURN(const Stores stores, OpenStores(options));
  CameraDirectory cameras;
  JobRunner runner(*stores.jobs, settings.runner);
  runner.Handle(kCalibrateKind, CalibrationJob(*stores.objects, options.limits), CalibrationStages());
  if (options.role != Role::kWorker) {
    AddCaptureRoutes(service.router(), {*stores.objects, *stores.jobs, cameras, options.limits, options.public_url,
                                        settings.reconstruction_url});
  }
  WatchStores(service, stores);
  service.OnDrain([&runner] { runner.Stop(); });
  if (options.role != Role::kApi) DRUPE_RETURN_IF_ERROR(runner.Start());
  exit_code = service.Run();
  return Status::Ok();
}

}  // namespace
}  // namespace drupe

int main(int argc, char** argv) {
  drupe::Service service("drupe-capture", 8081, "Finds cameras and calibrates them.");
  drupe::Settings settings;
  service.AddOption("--reconstruction-url", settings.reconstruction_url,
                    "service that reconstructs with the calibrations; for links");
  service.AddOption("--workers", settings.runner.workers, "calibrations at once");
  service.AddOption("--threads", settings.runner.threads_per_job, "threads of a calibration, 0 for one per core");
  if (const std::optional<int> exit_code = service.Parse(argc, argv)) return *exit_code;
  int exit_code = 1;
  const drupe::Status served = drupe::Serve(service, settings, exit_code);
  if (!served.ok()) drupe::Log(drupe::LogLevel::kError, "cannot start", {{"error", served.ToString()}});
  return exit_code;
}
