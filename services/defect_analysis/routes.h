#pragma once

#include <string>

#include "defect_analysis/analysis_service.h"
#include "http/router.h"

namespace drupe {

/// Adds POST /analyze, GET /reports, GET /reports/ID and GET /reports/ID.csv. `service` must outlive the router;
/// `public_url` leads the links in replies.
void AddAnalysisRoutes(AnalysisService& service, const std::string& public_url, Router& router);

}  // namespace drupe
