#pragma once

#include <string>

#include "defect_analysis/analysis_service.h"
#include "http/router.h"
#include "service/webhooks.h"

namespace drupe {

/// What a webhook says of an analysis.
Json DescribeAnalysis(const Job& job, const std::string& public_url);

/// Adds POST /analyze, GET /reports, GET /reports/ID and GET /reports/ID.csv. `service` and `webhooks` must outlive the
/// router; `public_url` leads the links in replies.
void AddAnalysisRoutes(AnalysisService& service, Webhooks& webhooks, const std::string& public_url, Router& router);

}  // namespace drupe
