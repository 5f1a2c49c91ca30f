#pragma once

#include "base/limits.h"
#include "http/router.h"
#include "jobs/job_store.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/reconstruction_status.h"
#include "service/webhooks.h"
#include "store/object_store.h"

namespace drupe {

/// What the routes work on; everything outlives the server.
struct RouteContext {
  ObjectStore& objects;
  JobStore& jobs;
  ImageSetStore& sets;
  Limits limits;
  LinkBase links;
  Webhooks& webhooks;
  bool prepare = true;  ///< leave a job for every picture that arrives in a set, so that its features are found at once
};

/// POST /reconstruct, GET /reconstructions, and what lies below /reconstructions/ID.
void AddReconstructionRoutes(Router& router, const RouteContext& context);

/// POST /image-sets, GET /image-sets/ID, PUT /image-sets/ID/images/NAME.
void AddImageSetRoutes(Router& router, const RouteContext& context);

}  // namespace drupe
