#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "base/log.h"
#include "defect_analysis/analysis_job.h"
#include "defect_analysis/analysis_service.h"
#include "defect_analysis/model_routes.h"
#include "defect_analysis/routes.h"
#include "defect_analysis/train_job.h"
#include "http/service.h"
#include "jobs/job_runner.h"
#include "service/service_stores.h"
#include "service/store_keeper.h"
#include "service/webhooks.h"
#include "service/worker.h"

namespace drupe {
namespace {

constexpr int kDefaultPort = 8083;

/// Everything that the service keeps, in the order in which it depends on one another.
struct Analysis {
  ServiceStores stores;
  std::optional<ReportIndex> index;
  std::optional<ReconstructionClient> reconstructions;
  std::optional<AnalysisJob> job;
  std::optional<AnalysisService> service;
  std::unique_ptr<Webhooks> webhooks;
  std::optional<StoreKeeper> keeper;
  std::optional<JobRunner> runner;
};

Status OpenStores(const ServiceOptions& options, Analysis& analysis) {
  DRUPE_ASSIGN_OR_RETURN(analysis.stores, OpenServiceStores(options, "analysis"));
  DRUPE_ASSIGN_OR_RETURN(analysis.index, ReportIndex::Open(*analysis.stores.database));
  DRUPE_ASSIGN_OR_RETURN(WebhookOptions hooks, ReadWebhookOptions(options));
  const auto describe = [url = options.public_url](const Job& job) { return DescribeAnalysis(job, url); };
  DRUPE_ASSIGN_OR_RETURN(analysis.webhooks,
                         Webhooks::Open(*analysis.stores.database, *analysis.stores.jobs, std::move(hooks), describe));
  const auto forget = [&analysis](std::int64_t before_ms) {
    const Status reports = analysis.index->ForgetGone(before_ms);
    return reports.ok() ? analysis.webhooks->ForgetGone() : reports;
  };
  analysis.keeper.emplace(analysis.stores,
                          KeeperOptions(options, "analysis", {std::string(kAnalyzeKind), kWebhookKind}), forget);
  return Status::Ok();
}

Status StartWorking(const std::string& reconstruction_url, JobRunnerOptions options, Service& frame,
                    Analysis& analysis) {
  DRUPE_ASSIGN_OR_RETURN(analysis.reconstructions,
                         ReconstructionClient::Create(reconstruction_url, *analysis.stores.objects));
  analysis.job.emplace(*analysis.reconstructions, *analysis.stores.objects, *analysis.index);
  CountAttempts(frame.metrics(), options);
  analysis.runner.emplace(*analysis.stores.jobs, options);
  analysis.runner->Handle(
      std::string(kAnalyzeKind),
      [&job = *analysis.job](const Job& claimed, const RunContext& context) { return job.Run(claimed, context); },
      AnalysisStages());
  analysis.runner->Handle(std::string(kTrainKind), TrainJob(*analysis.stores.objects, frame.options().limits),
                          TrainStages());
  frame.OnDrain([&analysis] {
    analysis.runner->Stop();
    analysis.webhooks->Stop();
  });
  DRUPE_RETURN_IF_ERROR(analysis.webhooks->Start(WorkerName("webhook")));
  return analysis.runner->Start();
}

int Main(int argc, char** argv) {
  Service frame("drupe-analysis", kDefaultPort, "Finds and measures the defects of reconstructed fruit.");
  std::string reconstruction_url = "http://127.0.0.1:8082";
  JobRunnerOptions runner;
  double lease_s = 30;
  frame.AddOption("--reconstruction-url", reconstruction_url, "Where reconstructions are fetched from");
  frame.AddOption("--workers", runner.workers, "Analyses and trainings done at once");
  frame.AddOption("--lease-s", lease_s, "Seconds after which a worker that has fallen silent loses its job to another");
  frame.AddOption("--threads", runner.threads_per_job, "Threads of one analysis; 0: one per core");
  if (const std::optional<int> exit_code = frame.Parse(argc, argv)) return *exit_code;

  runner.worker_name = WorkerName("analyze");
  runner.lease_ms = static_cast<std::int64_t>(lease_s * 1000);

  const ServiceOptions& options = frame.options();
  Analysis analysis;
  Status started = OpenStores(options, analysis);
  if (started.ok()) {
    analysis.service.emplace(*analysis.stores.jobs, *analysis.index, *analysis.stores.objects);
    WatchStores(frame, analysis.stores);
    if (options.role != Role::kWorker) {
      AddAnalysisRoutes(*analysis.service, *analysis.webhooks, options.public_url, frame.router());
      AddStoreRoutes(frame, analysis.stores);
      AddModelRoutes(frame.router(),
                     {analysis.service->models(), *analysis.stores.objects, options.limits, options.public_url});
      analysis.keeper->Start();
      frame.OnDrain([&analysis] { analysis.keeper->Stop(); });
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
