#pragma once

#include <string>

#include "base/json.h"
#include "jobs/job.h"

namespace drupe {

/// Where the links in replies lead.
struct LinkBase {
  std::string self;      ///< before "/reconstructions/..."; empty: relative links
  std::string analysis;  ///< before "/reports/..."
};

/// The reply of GET /reconstructions/ID: {"id", "status", "stage", "progress", "attempt", "created_at", "started_at",
/// "finished_at", "error", "image_set", "images", "refused_images", "quality", "timings", "artifacts", "provenance",
/// "links"}. Quality, timings and artifacts come with success.
Json StatusJson(const Job& job, const LinkBase& base);

/// The short form, for lists, events and the reply to a submission: without provenance, quality and timings.
Json SummaryJson(const Job& job, const LinkBase& base);

}  // namespace drupe
