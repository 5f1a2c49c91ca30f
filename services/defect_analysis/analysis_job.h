#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "base/clock.h"
#include "base/json.h"
#include "base/run_context.h"
#include "base/status.h"
#include "defect_analysis/pipeline.h"
#include "defect_analysis/reconstruction_client.h"
#include "defect_analysis/report_index.h"
#include "jobs/job.h"
#include "jobs/job_runner.h"
#include "store/object_store.h"

namespace drupe {

/// The kind of the analysis' jobs: subject is the reconstruction's id, payload {"options": {...}} and, where those name
/// a trained background model, "background_model", the SHA-256 of its file.
inline constexpr std::string_view kAnalyzeKind = "analyze";

/// The stages of an analysis job and their usual shares of its time.
std::vector<StageShare> AnalysisStages();

/// Does one analysis job: fetches the reconstruction, runs the pipeline, stores the report and its other files
/// (MakeReportFiles), and enters them in the index. Repeating a job whose report is already there changes nothing. The
/// pictures of defects come when the object store has the photographs; where they cannot be drawn, the report does
/// without them.
class AnalysisJob {
 public:
  /// All of them must outlive this object.
  AnalysisJob(const ReconstructionClient& reconstructions, ObjectStore& objects, ReportIndex& index,
              const Clock& clock = Clock::System())
      : reconstructions_(reconstructions), objects_(objects), index_(index), clock_(clock) {}

  /// The job's result, {"report": SHA-256 of the JSON}. Errors: those of ReconstructionClient::Fetch, RunAnalysis and
  /// the stores.
  Result<Json> Run(const Job& job, const RunContext& context) const;

 private:
  Result<FetchedReconstruction> Fetch(const Job& job, const RunContext& context) const;
  /// Takes quality, times and provenance out of `fetched`.
  Result<Report> MakeReport(const Job& job, FetchedReconstruction& fetched, const RunContext& context,
                            std::int64_t now_ms) const;
  Result<std::vector<Artifact>> StoreFiles(const Report& report, const FetchedReconstruction& fetched) const;

  const ReconstructionClient& reconstructions_;
  ObjectStore& objects_;
  ReportIndex& index_;
  const Clock& clock_;
};

}  // namespace drupe
