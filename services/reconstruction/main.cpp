#include <memory>
#include <optional>
#include <string>

#include "base/log.h"
#include "http/client.h"
#include "http/service.h"
#include "jobs/job_runner.h"
#include "jobs/sqlite/sqlite_job_store.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/reconstruct_job.h"
#include "reconstruction/routes.h"
#include "store/object_store.h"

namespace drupe {
namespace {

/// What the user may set beyond the options of every service.
struct Settings {
  std::string analysis_url = "http://127.0.0.1:8083";
  std::string public_analysis_url;
  int workers = 1;
  int threads = 0;
  double drain_s = 20;
};

/// The stores of the service, in the order in which they depend on one another.
struct Stores {
  std::unique_ptr<ObjectStore> objects;
  std::unique_ptr<SqliteDatabase> database;
  std::unique_ptr<JobStore> jobs;
  std::unique_ptr<ImageSetStore> sets;
};

Result<Stores> OpenStores(const ServiceOptions& options) {
  Stores stores;
  DRUPE_ASSIGN_OR_RETURN(stores.objects, ObjectStore::Open(options.data / "objects"));
  DRUPE_ASSIGN_OR_RETURN(stores.database, SqliteDatabase::Open(options.data / "reconstruction.db"));
  DRUPE_ASSIGN_OR_RETURN(stores.jobs, OpenSqliteJobStore(*stores.database));
  DRUPE_ASSIGN_OR_RETURN(stores.sets, ImageSetStore::Open(*stores.database, options.limits));
  return stores;
}

void AddMetrics(Metrics& metrics, JobStore& jobs) {
  const auto add = [&](const char* state, std::int64_t JobCounts::*member) {
    metrics.AddGauge(std::string("drupe_jobs_") + state, "Jobs in this state.", [&jobs, member] {
      const Result<JobCounts> counts = jobs.Counts();
      return counts.ok() ? static_cast<double>((*counts).*member) : -1.0;
    });
  };
  add("queued", &JobCounts::queued);
  add("running", &JobCounts::running);
  add("succeeded", &JobCounts::succeeded);
  add("failed", &JobCounts::failed);
  add("cancelled", &JobCounts::cancelled);
}

JobRunnerOptions RunnerOptions(const Settings& settings, int workers, const std::string& name) {
  JobRunnerOptions options;
  options.workers = workers;
  options.threads_per_job = settings.threads;
  options.drain_ms = static_cast<std::int64_t>(settings.drain_s * 1000);
  options.worker_name = name;
  return options;
}

/// The two kinds of work. Announcements have a runner of their own, so that they never wait for a reconstruction.
class Workers {
 public:
  Workers(Stores& stores, const Settings& settings, const Limits& limits, const Client& analysis)
      : jobs_(*stores.jobs),
        reconstructions_(*stores.jobs, RunnerOptions(settings, settings.workers, "reconstruct")),
        announcements_(*stores.jobs, RunnerOptions(settings, 1, "announce")) {
    reconstructions_.Handle(kReconstructKind, ReconstructJob(*stores.objects, *stores.jobs, limits),
                            ReconstructStages());
    announcements_.Handle(kAnnounceKind, AnnounceJob(*stores.jobs, analysis));
  }

  Status Start() {
    DRUPE_RETURN_IF_ERROR(ReviveAnnouncements(jobs_));
    DRUPE_RETURN_IF_ERROR(reconstructions_.Start());
    return announcements_.Start();
  }
  void Stop() {
    reconstructions_.Stop();
    announcements_.Stop();
  }

 private:
  JobStore& jobs_;
  JobRunner reconstructions_;
  JobRunner announcements_;
};

Status Serve(Service& service, const Settings& settings, int& exit_code) {
  const ServiceOptions& options = service.options();
  DRUPE_ASSIGN_OR_RETURN(Stores stores, OpenStores(options));
  DRUPE_ASSIGN_OR_RETURN(const Client analysis, Client::Create(settings.analysis_url));
  Workers workers(stores, settings, options.limits, analysis);
  if (options.role != Role::kWorker) {
    const std::string& report_url =
        settings.public_analysis_url.empty() ? settings.analysis_url : settings.public_analysis_url;
    const RouteContext context{
        *stores.objects, *stores.jobs, *stores.sets, options.limits, {options.public_url, report_url}};
    AddReconstructionRoutes(service.router(), context);
    AddImageSetRoutes(service.router(), context);
  }
  AddMetrics(service.metrics(), *stores.jobs);
  service.AddReadinessCheck("objects", [&] { return stores.objects->CheckWritable(); });
  service.AddReadinessCheck("jobs", [&] { return stores.jobs->Counts().status(); });
  service.OnDrain([&] { workers.Stop(); });
  if (options.role != Role::kApi) DRUPE_RETURN_IF_ERROR(workers.Start());
  exit_code = service.Run();
  return Status::Ok();
}

}  // namespace
}  // namespace drupe

int main(int argc, char** argv) {
  drupe::Service service("drupe-reconstruction", 8082,
                         "Rebuilds small fruit in 3D from image sets: cameras, sparse and dense points.");
  drupe::Settings settings;
  service.AddOption("--analysis-url", settings.analysis_url, "service that makes reports of finished reconstructions");
  service.AddOption("--public-analysis-url", settings.public_analysis_url,
                    "where users reach that service, for the link to the report; empty: --analysis-url");
  service.AddOption("--workers", settings.workers, "reconstructions at once");
  service.AddOption("--threads", settings.threads, "threads of a reconstruction, 0 for one per core");
  service.AddOption("--drain-s", settings.drain_s, "seconds that running jobs are given when the service stops");
  if (const std::optional<int> exit_code = service.Parse(argc, argv)) return *exit_code;
  int exit_code = 1;
  const drupe::Status served = drupe::Serve(service, settings, exit_code);
  if (!served.ok()) drupe::Log(drupe::LogLevel::kError, "cannot start", {{"error", served.ToString()}});
  return exit_code;
}
