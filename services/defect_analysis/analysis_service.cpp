#include "defect_analysis/analysis_service.h"

#include "base/digest.h"
#include "base/ids.h"
#include "defect_analysis/analysis_job.h"
#include "defect_analysis/pipeline.h"

namespace drupe {

namespace {

// Enough, with the backoff, for the reconstruction service to be away for some minutes.
constexpr int kMaxAttempts = 10;

Status ReportNotFound(std::string_view reconstruction) {
  return NotFound("report_not_found", "no analysis of " + std::string(reconstruction) + " was asked for");
}

/// Names the analysis of a reconstruction with these options, whatever the order of their keys.
std::string KeyOf(const std::string& reconstruction, const Json& options) {
  return reconstruction + ":" + Sha256Hex(nlohmann::json(options).dump());
}

}  // namespace

Result<Job> AnalysisService::Analyze(const std::string& reconstruction, const Json& options) {
  if (!IsId(reconstruction, "rec")) {
    return InvalidArgument("invalid_id", "a reconstruction's id looks like rec_0a1b2c", "reconstruction");
  }
  DRUPE_RETURN_IF_ERROR(ParseAnalysisOptions(options).status());
  DRUPE_ASSIGN_OR_RETURN(Job job, Submit(reconstruction, options));
  if (job.state == JobState::kFailed) {
    Result<Job> retried = jobs_.Retry(job.id);
    // A conflict means that another request was faster.
    if (!retried.ok() && retried.status().kind() != StatusKind::kConflict) return retried;
    if (retried.ok()) job = std::move(*retried);
  }
  DRUPE_RETURN_IF_ERROR(index_.SetCurrentJob(reconstruction, job.id));
  return job;
}

Result<Job> AnalysisService::Submit(const std::string& reconstruction, const Json& options) {
  JobSpec spec;
  spec.kind = kAnalyzeKind;
  spec.id_prefix = "ana";
  spec.subject = reconstruction;
  spec.payload = {{"options", options}};
  DRUPE_ASSIGN_OR_RETURN(const AnalysisOptions parsed, ParseAnalysisOptions(options));
  if (IsId(parsed.background.model, "mdl")) {
    DRUPE_ASSIGN_OR_RETURN(spec.payload["background_model"], models_.FileOf(parsed.background.model));
  }
  spec.idempotency_key = KeyOf(reconstruction, options);
  spec.max_attempts = kMaxAttempts;
  return jobs_.Submit(spec);
}

Result<AnalysisState> AnalysisService::Find(const std::string& reconstruction) {
  DRUPE_ASSIGN_OR_RETURN(const std::optional<std::string> id, index_.CurrentJob(reconstruction));
  if (!id) return ReportNotFound(reconstruction);
  AnalysisState state;
  DRUPE_ASSIGN_OR_RETURN(state.job, jobs_.Get(*id));
  if (state.job.state == JobState::kSucceeded) {
    DRUPE_ASSIGN_OR_RETURN(state.report, index_.FindByJob(*id));
  }
  return state;
}

Status AnalysisService::SendArtifact(const Request& request, const AnalysisState& state, Response& response) {
  return drupe::SendArtifact(request, state.job, ArtifactsOf(state), objects_, response);
}

Result<std::string> AnalysisService::Read(const ReportEntry& report, ReportFormat format) {
  return objects_.Get(format == ReportFormat::kJson ? report.json_sha256 : report.csv_sha256);
}

Status ErrorOfEndedJob(const Job& job) {
  if (!job.error) return Internal("analysis_ended", "the analysis has ended without a report");
  const bool exhausted = job.error->code == "attempts_exhausted";
  return {exhausted ? StatusKind::kInternal : StatusKind::kUnprocessable, job.error->code,
          "the analysis has failed: " + job.error->message, job.error->field};
}

}  // namespace drupe
