#pragma once

#include <memory>
#include <string>

#include "http/service.h"
#include "jobs/job_store.h"
#include "jobs/sql/database.h"
#include "store/object_store.h"

namespace drupe {

/// What every service keeps, in the order in which it depends on one another.
struct ServiceStores {
  std::unique_ptr<ObjectStore> objects;  ///< DATA/objects
  std::unique_ptr<Database> database;    ///< --jobs-url; holds the service's own tables too
  std::unique_ptr<JobStore> jobs;
};

/// `service` is the name without "drupe-". Errors: those of ObjectStore::Open, OpenDatabase and OpenJobStore.
Result<ServiceStores> OpenServiceStores(const ServiceOptions& options, const std::string& service);

/// Adds what operators see of the stores: readiness checks and gauges of the queue and of the disk. `stores` must
/// outlive the service.
void WatchStores(Service& service, ServiceStores& stores);

}  // namespace drupe
