#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "base/log.h"
#include "http/client.h"
#include "http/service.h"
#include "jobs/job_runner.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/object_derived_cache.h"
#include "reconstruction/part_jobs.h"
#include "reconstruction/prepare_job.h"
#include "reconstruction/reconstruct_job.h"
#include "reconstruction/routes.h"
#include "service/service_stores.h"
#include "service/store_keeper.h"
#include "service/webhooks.h"
#include "service/worker.h"

namespace drupe {
namespace {

/// What the user may set beyond the options of every service.
struct Settings {
  std::string analysis_url = "http://127.0.0.1:8083";
  std::string public_analysis_url;
  int workers = 1;
  int threads = 0;
  double drain_s = 20;
  double lease_s = 30;
  int prepare_workers = -1;
  int cache_mb = 4096;
};

/// The stores of every service, and this one's own tables.
struct Stores : ServiceStores {
  std::unique_ptr<ImageSetStore> sets;
  std::unique_ptr<ObjectDerivedCache> derived;
};

Result<Stores> OpenStores(const ServiceOptions& options, const Settings& settings) {
  DRUPE_ASSIGN_OR_RETURN(ServiceStores common, OpenServiceStores(options, "reconstruction"));
  Stores stores{std::move(common), nullptr, nullptr};
  DRUPE_ASSIGN_OR_RETURN(stores.sets, ImageSetStore::Open(*stores.database, options.limits));
  DRUPE_ASSIGN_OR_RETURN(stores.derived, ObjectDerivedCache::Open(*stores.database, *stores.objects,
                                                                  std::int64_t{settings.cache_mb} * 1'000'000));
  return stores;
}

void AddCacheMetrics(Metrics& metrics, const ObjectDerivedCache& derived) {
  metrics.AddGauge("drupe_derived_hits", "What was known of a picture and not computed again, since the start.",
                   [&derived] { return static_cast<double>(derived.hits()); });
  metrics.AddGauge("drupe_derived_misses", "What had to be computed of a picture, since the start.",
                   [&derived] { return static_cast<double>(derived.misses()); });
}

/// By default, half of the cores.
int PrepareWorkers(const Settings& settings) {
  if (settings.prepare_workers >= 0) return settings.prepare_workers;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / 2);
}

JobRunnerOptions RunnerOptions(const Settings& settings, int workers, const std::string& name, Metrics& metrics) {
  JobRunnerOptions options;
  options.workers = workers;
  options.threads_per_job = settings.threads;
  options.drain_ms = static_cast<std::int64_t>(settings.drain_s * 1000);
  options.lease_ms = static_cast<std::int64_t>(settings.lease_s * 1000);
  options.worker_name = WorkerName(name);
  CountAttempts(metrics, options);
  return options;
}

/// Forgets image sets, and webhooks, together with the jobs that they belong to.
StoreKeeper::Forget ForgetWith(Stores& stores, Webhooks& webhooks) {
  return [&](std::int64_t before_ms) {
    const Status sets = stores.sets->ForgetUnused(before_ms);
    return sets.ok() ? webhooks.ForgetGone() : sets;
  };
}

/// What a webhook says of a reconstruction.
Webhooks::Describe DescribeWith(const LinkBase& links) {
  return [links](const Job& job) {
    Json body = SummaryJson(job, links);
    body["event"] = std::string("reconstruction.") + JobStateName(job.state);
    return body;
  };
}

/// The kinds of work. Announcements have a runner of their own, so that they never wait for a reconstruction, and
/// so has what is done while pictures arrive, so that it never takes more than its threads.
class Workers {
 public:
  Workers(Stores& stores, const Settings& settings, const Limits& limits, const Client& analysis, Metrics& metrics)
      : jobs_(*stores.jobs),
        reconstructions_(*stores.jobs, RunnerOptions(settings, settings.workers, "reconstruct", metrics)),
        announcements_(*stores.jobs, RunnerOptions(settings, 1, "announce", metrics)),
        prepares_(PrepareWorkers(settings) > 0),
        preparations_(*stores.jobs,
                      RunnerOptions(settings, std::max(1, PrepareWorkers(settings)), "prepare", metrics)) {
    reconstructions_.Handle(kReconstructKind,
                            ReconstructJob(*stores.objects, *stores.jobs, stores.derived.get(), limits),
                            ReconstructStages());
    reconstructions_.Handle(kPartKind, PartJob(*stores.objects, limits));
    announcements_.Handle(kAnnounceKind, AnnounceJob(*stores.jobs, analysis));
    const ArrivalStores arrival{*stores.objects, *stores.sets, *stores.derived, limits};
    preparations_.Handle(kPrepareKind, PrepareJob(arrival));
    preparations_.Handle(kMatchKind, MatchJob(arrival));
  }

  Status Start() {
    DRUPE_RETURN_IF_ERROR(ReviveAnnouncements(jobs_));
    DRUPE_RETURN_IF_ERROR(reconstructions_.Start());
    if (prepares_) DRUPE_RETURN_IF_ERROR(preparations_.Start());
    return announcements_.Start();
  }
  void Stop() {
    preparations_.Stop(0);
    reconstructions_.Stop();
    announcements_.Stop();
  }

 private:
  JobStore& jobs_;
  JobRunner reconstructions_;
  JobRunner announcements_;
  const bool prepares_;
  JobRunner preparations_;
};

Status Serve(Service& service, const Settings& settings, int& exit_code) {
  const ServiceOptions& options = service.options();
  DRUPE_ASSIGN_OR_RETURN(Stores stores, OpenStores(options, settings));
  DRUPE_ASSIGN_OR_RETURN(const Client analysis, Client::Create(settings.analysis_url));
  const LinkBase links{options.public_url,
                       settings.public_analysis_url.empty() ? settings.analysis_url : settings.public_analysis_url};
  DRUPE_ASSIGN_OR_RETURN(WebhookOptions hooks, ReadWebhookOptions(options));
  DRUPE_ASSIGN_OR_RETURN(const auto webhooks,
                         Webhooks::Open(*stores.database, *stores.jobs, std::move(hooks), DescribeWith(links)));
  Workers workers(stores, settings, options.limits, analysis, service.metrics());
  StoreKeeper keeper(
      stores,
      KeeperOptions(options, "reconstruction",
                    {kReconstructKind, kPartKind, kAnnounceKind, kPrepareKind, kMatchKind, kWebhookKind}),
      ForgetWith(stores, *webhooks));
  if (options.role != Role::kWorker) {
    const RouteContext context{
        *stores.objects, *stores.jobs, *stores.sets, options.limits, links, *webhooks, PrepareWorkers(settings) > 0};
    AddReconstructionRoutes(service.router(), context);
    AddImageSetRoutes(service.router(), context);
    AddStoreRoutes(service, stores);
    keeper.Start();
  }
  AddCacheMetrics(service.metrics(), *stores.derived);
  WatchStores(service, stores);
  service.OnDrain([&] {
    keeper.Stop();
    workers.Stop();
    webhooks->Stop();
  });
  if (options.role != Role::kApi) {
    DRUPE_RETURN_IF_ERROR(workers.Start());
    DRUPE_RETURN_IF_ERROR(webhooks->Start(WorkerName("webhook")));
  }
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
  service.AddOption(
      "--prepare-workers", settings.prepare_workers,
      "threads that find features, likeness and matches while pictures arrive, 0 for none, -1 for half of the cores");
  service.AddOption("--cache-mb", settings.cache_mb, "disk space for what is known of pictures, 0 for none");
  service.AddOption("--lease-s", settings.lease_s,
                    "seconds after which a worker that has fallen silent loses its job to another");
  service.AddOption("--drain-s", settings.drain_s, "seconds that running jobs are given when the service stops");
  if (const std::optional<int> exit_code = service.Parse(argc, argv)) return *exit_code;
  int exit_code = 1;
  const drupe::Status served = drupe::Serve(service, settings, exit_code);
  if (!served.ok()) drupe::Log(drupe::LogLevel::kError, "cannot start", {{"error", served.ToString()}});
  return exit_code;
}
