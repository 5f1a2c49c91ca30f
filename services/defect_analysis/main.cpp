#include <memory>
#include <optional>
#include <string>

#include "base/log.h"
#include "defect_analysis/analysis_job.h"
#include "defect_analysis/analysis_service.h"
#include "defect_analysis/model_routes.h"
#include "defect_analysis/routes.h"
#include "defect_analysis/train_job.h"
#include "http/service.h"
#include "jobs/job_runner.h"
#include "jobs/sql/sql_job_store.h"
#include "jobs/sqlite/database.h"

namespace drupe {
namespace {

constexpr int kDefaultPort = 8083;

/// Everything that the service keeps, in the order in which it depends on one another.
struct Analysis {
  std::unique_ptr<ObjectStore> objects;
  std::unique_ptr<SqliteDatabase> database;
  std::unique_ptr<JobStore> jobs;
  std::optional<ReportIndex> index;
  std::optional<ReconstructionClient> reconstructions;
  std::optional<AnalysisJob> job;
  std::optional<AnalysisService> service;
  std::optional<JobRunner> runner;
};

Status OpenStores(const std::filesystem::path& data, Analysis& analysis) {
  DRUPE_ASSIGN_OR_RETURN(analysis.objects, ObjectStore::Open(data / "objects"));
  DRUPE_ASSIGN_OR_RETURN(analysis.database, SqliteDatabase::Open(data / "analysis.db"));
  DRUPE_ASSIGN_OR_RETURN(analysis.index, ReportIndex::Open(*analysis.database));
  DRUPE_ASSIGN_OR_RETURN(analysis.jobs, OpenJobStore(*analysis.database));
  return Status::Ok();
}

void CountAttempts(Metrics& metrics, JobRunnerOptions& options) {
  options.on_attempt = [&metrics](const Job& job, const Status& outcome, double wall_s) {
    const std::string result = outcome.ok() ? "succeeded" : "failed";
    metrics.Count("drupe_job_attempts_total", "Attempts at jobs that have ended", {{"outcome", result}});
    metrics.ObserveSeconds("drupe_job_seconds", "Wall time of an attempt at a job", {{"kind", job.kind}}, wall_s);
  };
}

void WatchStores(Service& frame, Analysis& analysis) {
  JobStore& jobs = *analysis.jobs;
  ObjectStore& objects = *analysis.objects;
  frame.AddReadinessCheck("jobs", [&jobs] { return jobs.Counts().status(); });
  frame.AddReadinessCheck("objects", [&objects] { return objects.CheckWritable(); });
  const auto gauge = [&](const std::string& name, const std::string& help, std::int64_t JobCounts::*count) {
    frame.metrics().AddGauge(name, help, [&jobs, count] {
      const auto counts = jobs.Counts();
      return counts.ok() ? static_cast<double>((*counts).*count) : 0.0;
    });
  };
  gauge("drupe_jobs_queued", "Jobs that wait", &JobCounts::queued);
  gauge("drupe_jobs_running", "Jobs that run", &JobCounts::running);
  gauge("drupe_jobs_failed", "Jobs that have failed for good", &JobCounts::failed);
}

Status StartWorking(const std::string& reconstruction_url, JobRunnerOptions options, Service& frame,
                    Analysis& analysis) {
  DRUPE_ASSIGN_OR_RETURN(analysis.reconstructions, ReconstructionClient::Create(reconstruction_url, *analysis.objects));
  analysis.job.emplace(*analysis.reconstructions, *analysis.objects, *analysis.index);
  CountAttempts(frame.metrics(), options);
  analysis.runner.emplace(*analysis.jobs, options);
  analysis.runner->Handle(
      std::string(kAnalyzeKind),
      [&job = *analysis.job](const Job& claimed, const RunContext& context) { return job.Run(claimed, context); },
      AnalysisStages());
  analysis.runner->Handle(std::string(kTrainKind), TrainJob(*analysis.objects, frame.options().limits), TrainStages());
  frame.OnDrain([&analysis] { analysis.runner->Stop(); });
  return analysis.runner->Start();
}

int Main(int argc, char** argv) {
  Service frame("drupe-analysis", kDefaultPort, "Finds and measures the defects of reconstructed fruit.");
  std::string reconstruction_url = "http://127.0.0.1:8082";
  JobRunnerOptions runner;
  frame.AddOption("--reconstruction-url", reconstruction_url, "Where reconstructions are fetched from");
  frame.AddOption("--workers", runner.workers, "Analyses and trainings done at once");
  frame.AddOption("--threads", runner.threads_per_job, "Threads of one analysis; 0: one per core");
  if (const std::optional<int> exit_code = frame.Parse(argc, argv)) return *exit_code;

  const ServiceOptions& options = frame.options();
  Analysis analysis;
  Status started = OpenStores(options.data, analysis);
  if (started.ok()) {
    analysis.service.emplace(*analysis.jobs, *analysis.index, *analysis.objects);
    WatchStores(frame, analysis);
    if (options.role != Role::kWorker) {
      AddAnalysisRoutes(*analysis.service, options.public_url, frame.router());
      AddModelRoutes(frame.router(),
                     {analysis.service->models(), *analysis.objects, options.limits, options.public_url});
    }
    if (options.role != Role::kApi) started = StartWorking(reconstruction_url, runner, frame, analysis);
  }
  if (!started.ok()) {
    Log(LogLevel::kError, "cannot start", {{"error", started.ToString()}});
    return 1;
  }
  return frame.Run();
}

}  // namespace
}  // namespace drupe

int main(int argc, char** argv) {
  return drupe::Main(argc, argv);
}
