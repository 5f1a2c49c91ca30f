#include "service/service_stores.h"

#include <algorithm>
#include <filesystem>

#include "jobs/sql/sql_job_store.h"
#include "service/job_routes.h"
#include "service/object_routes.h"
#include "service/open_database.h"
#include "service/remote_object_store.h"

namespace drupe {

namespace {

constexpr double kMsPerSecond = 1000;

void AddQueueGauges(Metrics& metrics, JobStore& jobs, const Clock& clock) {
  const auto add = [&](const std::string& state, std::int64_t JobCounts::*member) {
    metrics.AddGauge("drupe_jobs_" + state, "Jobs in this state; -1 while the database cannot be asked.",
                     [&jobs, member] {
                       const Result<JobCounts> counts = jobs.Counts();
                       return counts.ok() ? static_cast<double>((*counts).*member) : -1.0;
                     });
  };
  add("queued", &JobCounts::queued);
  add("running", &JobCounts::running);
  add("succeeded", &JobCounts::succeeded);
  add("failed", &JobCounts::failed);
  add("cancelled", &JobCounts::cancelled);
  metrics.AddGauge("drupe_jobs_oldest_queued_seconds", "How long the oldest queued job has waited; 0 when none waits.",
                   [&jobs, &clock] {
                     const Result<JobCounts> counts = jobs.Counts();
                     if (!counts.ok() || counts->oldest_queued_ms == 0) return 0.0;
                     const std::int64_t age_ms = clock.NowMs() - counts->oldest_queued_ms;
                     return static_cast<double>(std::max<std::int64_t>(0, age_ms)) / kMsPerSecond;
                   });
}

void AddDiskGauge(Metrics& metrics, const std::filesystem::path& data) {
  metrics.AddGauge("drupe_store_free_bytes", "Free space where the objects lie.", [data] {
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(data, error);
    return error ? -1.0 : static_cast<double>(space.available);
  });
}

Status OpenOnDisk(const std::filesystem::path& directory, const ServiceOptions& options, ServiceStores& stores) {
  const ObjectStoreOptions limits{.min_free_bytes = options.min_free_bytes,
                                  .max_total_bytes = options.store_quota_bytes};
  DRUPE_ASSIGN_OR_RETURN(auto store, DiskObjectStore::Open(directory, limits));
  stores.disk = store.get();
  stores.objects = std::move(store);
  return Status::Ok();
}

Status OpenObjects(const ServiceOptions& options, ServiceStores& stores) {
  constexpr std::string_view kFile = "file:";
  const std::string& url = options.store_url;
  if (url.empty()) return OpenOnDisk(options.data / "objects", options, stores);
  if (url.starts_with(kFile) && url.size() > kFile.size()) {
    return OpenOnDisk(url.substr(kFile.size()), options, stores);
  }
  if (!url.starts_with("http://")) {
    return InvalidArgument("invalid_store_url", "the objects are at file:PATH or http://HOST:PORT, not \"" + url + "\"",
                           "store_url");
  }
  const RemoteStoreOptions remote{.cache_bytes = options.store_cache_bytes, .min_free_bytes = options.min_free_bytes};
  DRUPE_ASSIGN_OR_RETURN(stores.objects, RemoteObjectStore::Open(url, options.data / "object-cache", remote));
  return Status::Ok();
}

}  // namespace

Result<ServiceStores> OpenServiceStores(const ServiceOptions& options, const std::string& service) {
  ServiceStores stores;
  DRUPE_RETURN_IF_ERROR(OpenObjects(options, stores));
  DRUPE_ASSIGN_OR_RETURN(stores.database, OpenDatabase(options.jobs_url, options.data, service));
  DRUPE_ASSIGN_OR_RETURN(stores.jobs, OpenJobStore(*stores.database));
  return stores;
}

void AddStoreRoutes(Service& service, ServiceStores& stores) {
  AddJobRoutes(service.router(), *stores.jobs);
  if (stores.disk != nullptr) AddObjectRoutes(service.router(), *stores.disk);
}

void WatchStores(Service& service, ServiceStores& stores) {
  JobStore& jobs = *stores.jobs;
  ObjectStore& objects = *stores.objects;
  service.AddReadinessCheck("jobs", [&jobs] { return jobs.Counts().status(); });
  service.AddReadinessCheck("objects", [&objects] { return objects.CheckWritable(0); });
  AddQueueGauges(service.metrics(), jobs, stores.database->clock());
  AddDiskGauge(service.metrics(), service.options().data);
}

}  // namespace drupe
