#include "defect_analysis/analysis_job.h"

#include <utility>

namespace drupe {

namespace {

Json ResultOf(const ReportEntry& entry) {
  return {{"report", entry.json_sha256}};
}

/// Stage times of the reconstruction, followed by those of the analysis.
Json JoinTimings(Json reconstruction, const Json& analysis) {
  if (analysis.is_object()) reconstruction.update(analysis);
  return reconstruction;
}

/// The trained background model that the payload names, if any.
Result<std::optional<ColourModel>> ReadBackgroundModel(const Json& payload, ObjectStore& objects) {
  if (!payload.contains("background_model")) return std::optional<ColourModel>();
  DRUPE_ASSIGN_OR_RETURN(const std::string text, objects.Get(payload["background_model"].get<std::string>()));
  DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(text, {.max_bytes = kMaxColourModelBytes}));
  DRUPE_ASSIGN_OR_RETURN(ColourModel model, ParseColourModel(json));
  return std::optional<ColourModel>(std::move(model));
}

}  // namespace

std::vector<StageShare> AnalysisStages() {
  return {{"fetch", 0.1}, {"fruit", 0.3}, {"defects", 0.5}, {"report", 0.1}};
}

Result<Json> AnalysisJob::Run(const Job& job, const RunContext& context) const {
  // A process that died between the index and the end of the job has left a report.
  DRUPE_ASSIGN_OR_RETURN(const std::optional<ReportEntry> known, index_.FindByJob(job.id));
  if (known) return ResultOf(*known);
  const std::int64_t now_ms = clock_.NowMs();
  DRUPE_ASSIGN_OR_RETURN(const Report report, MakeReport(job, context, now_ms));
  context.Report("report", 0);
  DRUPE_ASSIGN_OR_RETURN(const ReportEntry entry, StoreReport(job, report, now_ms));
  DRUPE_RETURN_IF_ERROR(index_.Add(entry));
  context.Report("report", 1);
  return ResultOf(entry);
}

Result<Report> AnalysisJob::MakeReport(const Job& job, const RunContext& context, std::int64_t now_ms) const {
  DRUPE_ASSIGN_OR_RETURN(const AnalysisOptions options, ParseAnalysisOptions(job.payload.at("options")));
  context.Report("fetch", 0);
  DRUPE_ASSIGN_OR_RETURN(FetchedReconstruction fetched, reconstructions_.Fetch(job.subject, context));
  DRUPE_ASSIGN_OR_RETURN(fetched.input.background_model, ReadBackgroundModel(job.payload, objects_));
  context.Report("fetch", 1);
  DRUPE_ASSIGN_OR_RETURN(Report report, RunAnalysis(fetched.input, options, context));
  report.id = job.subject;
  report.created_at = FormatUtc(now_ms);
  report.quality = std::move(fetched.quality);
  report.timings_s = JoinTimings(std::move(fetched.timings_s), report.timings_s);
  report.provenance = std::move(fetched.provenance);
  report.provenance.options = {{"reconstruction", report.provenance.options}, {"analysis", ToJson(options)}};
  return report;
}

Result<ReportEntry> AnalysisJob::StoreReport(const Job& job, const Report& report, std::int64_t now_ms) const {
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo json, objects_.Put(DumpJson(ToJson(report))));
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo csv, objects_.Put(ToCsv(report)));
  ReportEntry entry{.job = job.id, .reconstruction = job.subject, .created_ms = now_ms};
  for (const Fruit& fruit : report.fruits) {
    entry.grades.push_back(fruit.grade);
    entry.defects += static_cast<int>(fruit.defects.size());
  }
  entry.json_sha256 = json.sha256;
  entry.csv_sha256 = csv.sha256;
  return entry;
}

}  // namespace drupe
