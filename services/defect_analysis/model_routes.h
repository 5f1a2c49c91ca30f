#pragma once

#include <string>

#include "base/limits.h"
#include "defect_analysis/model_catalogue.h"
#include "http/router.h"
#include "store/object_store.h"

namespace drupe {

/// What the routes of the models work on; everything outlives the server.
struct ModelContext {
  ModelCatalogue& models;
  ObjectStore& objects;
  Limits limits;
  std::string public_url;  ///< before the links; empty: relative links
};

/// POST and GET /models, GET /models/default, GET /models/ID, GET /models/ID/model.json.
void AddModelRoutes(Router& router, const ModelContext& context);

}  // namespace drupe
