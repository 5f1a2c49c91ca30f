#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "defect_analysis/model_catalogue.h"
#include "defect_analysis/report_index.h"
#include "http/request.h"
#include "http/response.h"
#include "jobs/job_store.h"
#include "store/object_store.h"

namespace drupe {

/// The analysis of a reconstruction as a client sees it.
struct AnalysisState {
  Job job;
  std::optional<ReportEntry> report;  ///< once the job has succeeded
};

/// The files of its report; none before the job has succeeded.
inline std::vector<Artifact> ArtifactsOf(const AnalysisState& state) {
  return state.report ? state.report->artifacts : std::vector<Artifact>();
}

enum class ReportFormat { kJson, kCsv };

/// What the routes ask for: analyses are queued here, and their reports found. Thread-safe.
class AnalysisService {
 public:
  /// All of them must outlive the service.
  AnalysisService(JobStore& jobs, ReportIndex& index, ObjectStore& objects)
      : jobs_(jobs), index_(index), objects_(objects), models_(jobs, objects) {}

  /// Queues the analysis of a reconstruction and makes it the one whose report Find gives. The same reconstruction and
  /// options are the same job; one that has failed is tried again. Errors: 400 `invalid_id`; those of
  /// ParseAnalysisOptions, of ModelCatalogue::FileOf for the background model, and of JobStore::Submit.
  Result<Job> Analyze(const std::string& reconstruction, const Json& options);

  /// Errors: 404 `report_not_found` when no analysis of the reconstruction was asked for.
  Result<AnalysisState> Find(const std::string& reconstruction);
  Result<ReportPage> List(const ReportQuery& query) { return index_.List(query); }
  /// Answers with the file of the report that the route names. Errors: 404 `artifact_not_found`; those of the object
  /// store.
  Status SendArtifact(const Request& request, const AnalysisState& state, Response& response);
  /// A report's bytes, digest checked.
  Result<std::string> Read(const ReportEntry& report, ReportFormat format);
  ModelCatalogue& models() { return models_; }

 private:
  Result<Job> Submit(const std::string& reconstruction, const Json& options);

  JobStore& jobs_;
  ReportIndex& index_;
  ObjectStore& objects_;
  ModelCatalogue models_;
};

/// What the end of an analysis that gave no report means to the one who asks for the report: 422 with the job's error
/// when the input is to blame, 500 when attempts are exhausted.
Status ErrorOfEndedJob(const Job& job);

}  // namespace drupe
