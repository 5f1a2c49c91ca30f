#include "defect_analysis/analysis_job.h"

#include <map>
#include <string>
#include <utility>

#include "base/limits.h"
#include "base/log.h"
#include "defect_analysis/report/report_files.h"

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

/// The photographs in the store; empty unless it has that of every registered view, which it does where the services
/// share a data directory. A contact sheet without some of the defects would pass for all of them.
PhotographSource PhotographsIn(ObjectStore& objects, const FetchedReconstruction& fetched) {
  bool any = false;
  for (std::size_t view = 0; view < fetched.photographs.size(); ++view) {
    if (!fetched.model.views[view].cam_from_world) continue;
    if (!objects.Contains(fetched.photographs[view])) return {};
    any = true;
  }
  if (!any) return {};
  return [&objects, &fetched](std::size_t view) {
    return objects.Get(fetched.photographs[view], Limits().max_image_bytes);
  };
}

Result<std::map<std::string, std::string>> MakeFiles(const Report& report, const FetchedReconstruction& fetched,
                                                     const PhotographSource& photographs) {
  const auto make = [&](const PhotographSource& source) {
    return MakeReportFiles(report, fetched.input.cloud, fetched.model, source);
  };
  auto files = make(photographs);
  if (files.ok() || !photographs) return files;
  Log(LogLevel::kWarning, "a report goes without pictures",
      {{"reconstruction", report.id}, {"why", files.status().ToString()}});
  return make({});
}

ReportEntry EntryOf(const Job& job, const Report& report, std::vector<Artifact> artifacts, std::int64_t now_ms) {
  ReportEntry entry{.job = job.id, .reconstruction = job.subject, .created_ms = now_ms};
  for (const Fruit& fruit : report.fruits) {
    entry.grades.push_back(fruit.grade);
    entry.defects += static_cast<int>(fruit.defects.size());
  }
  for (const Artifact& artifact : artifacts) {
    if (artifact.name == "report.json") entry.json_sha256 = artifact.sha256;
    if (artifact.name == "report.csv") entry.csv_sha256 = artifact.sha256;
  }
  entry.artifacts = std::move(artifacts);
  return entry;
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
  DRUPE_ASSIGN_OR_RETURN(FetchedReconstruction fetched, Fetch(job, context));
  DRUPE_ASSIGN_OR_RETURN(const Report report, MakeReport(job, fetched, context, now_ms));
  context.Report("report", 0);
  DRUPE_ASSIGN_OR_RETURN(std::vector<Artifact> artifacts, StoreFiles(report, fetched));
  const ReportEntry entry = EntryOf(job, report, std::move(artifacts), now_ms);
  DRUPE_RETURN_IF_ERROR(index_.Add(entry));
  context.Report("report", 1);
  return ResultOf(entry);
}

Result<FetchedReconstruction> AnalysisJob::Fetch(const Job& job, const RunContext& context) const {
  context.Report("fetch", 0);
  DRUPE_ASSIGN_OR_RETURN(FetchedReconstruction fetched, reconstructions_.Fetch(job.subject, context));
  DRUPE_ASSIGN_OR_RETURN(fetched.input.background_model, ReadBackgroundModel(job.payload, objects_));
  context.Report("fetch", 1);
  return fetched;
}

Result<Report> AnalysisJob::MakeReport(const Job& job, FetchedReconstruction& fetched, const RunContext& context,
                                       std::int64_t now_ms) const {
  DRUPE_ASSIGN_OR_RETURN(const AnalysisOptions options, ParseAnalysisOptions(job.payload.at("options")));
  DRUPE_ASSIGN_OR_RETURN(Report report, RunAnalysis(fetched.input, options, context));
  report.id = job.subject;
  report.created_at = FormatUtc(now_ms);
  report.quality = std::move(fetched.quality);
  report.timings_s = JoinTimings(std::move(fetched.timings_s), report.timings_s);
  report.provenance = std::move(fetched.provenance);
  report.provenance.options = {{"reconstruction", report.provenance.options}, {"analysis", ToJson(options)}};
  return report;
}

Result<std::vector<Artifact>> AnalysisJob::StoreFiles(const Report& report,
                                                      const FetchedReconstruction& fetched) const {
  using Files = std::map<std::string, std::string>;
  DRUPE_ASSIGN_OR_RETURN(const Files files, MakeFiles(report, fetched, PhotographsIn(objects_, fetched)));
  return StoreArtifacts(files, objects_);
}

}  // namespace drupe
