#pragma once

#include <memory>
#include <string>

#include "http/service.h"
#include "jobs/job_store.h"
#include "jobs/sql/database.h"
#include "store/disk_object_store.h"

namespace drupe {

/// What every service keeps, in the order in which it depends on one another.
struct ServiceStores {
  std::unique_ptr<ObjectStore> objects;  ///< --store-url
  DiskObjectStore* disk = nullptr;       ///< the same when it is on this machine's disk
  std::unique_ptr<Database> database;    ///< --jobs-url; holds the service's own tables too
  std::unique_ptr<JobStore> jobs;
};

/// `service` is the name without "drupe-". Errors: 400 `invalid_store_url`;
/// those of DiskObjectStore::Open, RemoteObjectStore::Open, OpenDatabase and OpenJobStore.
Result<ServiceStores> OpenServiceStores(const ServiceOptions& options, const std::string& service);

/// Adds the routes of the queue, and of the objects where they are on this machine's disk, for operators and for the
/// services of other machines. `stores` must outlive the service.
void AddStoreRoutes(Service& service, ServiceStores& stores);

/// Adds what operators see of the stores: readiness checks and gauges of the queue and of the disk. `stores` must
/// outlive the service.
void WatchStores(Service& service, ServiceStores& stores);

}  // namespace drupe
