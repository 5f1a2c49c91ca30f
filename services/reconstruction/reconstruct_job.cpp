#include "reconstruction/reconstruct_job.h"

#include <chrono>
#include <map>
#include <thread>
#include <utility>

#include "base/log.h"
#include "reconstruction/intake.h"
#include "reconstruction/part_jobs.h"
#include "reconstruction/pipeline.h"
#include "reconstruction/reconstruct_input.h"
#include "reconstruction/reconstruct_request.h"
#include "service/artifacts.h"

namespace drupe {

namespace {

constexpr int kAnnounceAttempts = 100;   ///< with pauses of up to a minute
constexpr int kAnnouncePriority = 10;    ///< before reconstructions, since it takes no time
constexpr int kWaitForCompletion = 100;  ///< looks at a job that is about to be recorded as succeeded
constexpr std::chrono::milliseconds kLook{50};

/// Everything that is to be kept of a reconstruction; the board is among it, because the analysis needs it.
Result<std::map<std::string, std::string>> CollectArtifacts(const ReconstructionOutput& output,
                                                            const ReconstructRequest& request) {
  using Artifacts = std::map<std::string, std::string>;
  DRUPE_ASSIGN_OR_RETURN(Artifacts artifacts, MakeArtifacts(output));
  if (request.board) artifacts["board.json"] = DumpJson(ToJson(*request.board), 1) + "\n";
  return artifacts;
}

/// Left before the reconstruction is recorded as succeeded, so that no crash can come between the two; a repetition of
/// the reconstruction finds the same announcement by its key.
Status LeaveAnnouncement(const Job& job, const ReconstructRequest& request, JobStore& jobs) {
  if (!request.analyze) return Status::Ok();
  JobSpec spec;
  spec.kind = kAnnounceKind;
  spec.id_prefix = "ann";
  spec.subject = job.id;
  spec.payload = {{"reconstruction", job.id}, {"options", request.analysis_options}};
  if (!request.webhook.empty()) spec.payload["webhook"] = request.webhook;
  spec.priority = kAnnouncePriority;
  spec.idempotency_key = "announce:" + job.id;
  spec.max_attempts = kAnnounceAttempts;
  const Result<Job> left = jobs.Submit(spec);
  return left.ok() ? Status::Ok() : left.status();
}

/// The reconstruction once it has ended. It usually has, save for the moment between the announcement and its end.
Result<Job> WaitUntilEnded(JobStore& jobs, const std::string& id, const RunContext& context) {
  for (int look = 0; look < kWaitForCompletion && !context.IsCancelled(); ++look) {
    DRUPE_ASSIGN_OR_RETURN(Job job, jobs.Get(id));
    if (IsTerminal(job.state)) return job;
    std::this_thread::sleep_for(kLook);
  }
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  return Status(StatusKind::kUnavailable, "not_ended", "the reconstruction has not ended yet");
}

}  // namespace

Result<Json> ReconstructJob::operator()(const Job& job, const RunContext& context) const {
  DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest request, FromPayload(job.payload));
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOptions options, ParseReconstructionOptions(request.options));
  ReconstructionInput input = MakeInput(request, objects_, cache_, limits_);
  PartJobs parts(jobs_, objects_, job, context);
  input.run_parts = [&](const StageParts& work) { return parts.Run(work); };
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOutput output, RunReconstruction(input, options, context));
  using Artifacts = std::map<std::string, std::string>;
  DRUPE_ASSIGN_OR_RETURN(const Artifacts artifacts, CollectArtifacts(output, request));
  DRUPE_ASSIGN_OR_RETURN(const std::vector<Artifact> stored, StoreArtifacts(artifacts, objects_));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  DRUPE_RETURN_IF_ERROR(LeaveAnnouncement(job, request, jobs_));
  Log(LogLevel::kInfo, "reconstructed",
      {{"job", job.id},
       {"registered", output.model.RegisteredCount()},
       {"points", output.cloud.size()},
       {"wall_s", output.timings.total_wall_s}});
  return Json{{"artifacts", ToJson(stored)},
              {"quality", QualityJson(output)},
              {"timings", ToJson(output.timings)},
              {"options", ToJson(options)},
              {"refused_images", ToJson(output.refused)}};
}

std::vector<StageShare> ReconstructStages() {
  std::vector<StageShare> shares;
  for (const PipelineStage& stage : ReconstructionStages()) shares.push_back({stage.name, stage.share});
  return shares;
}

Result<Json> AnnounceJob::operator()(const Job& job, const RunContext& context) const {
  const std::string id = job.payload.value("reconstruction", "");
  DRUPE_ASSIGN_OR_RETURN(const Job reconstruction, WaitUntilEnded(jobs_, id, context));
  if (reconstruction.state != JobState::kSucceeded) return Json{{"skipped", JobStateName(reconstruction.state)}};
  Result<Client::Reply> reply = analysis_.Post("/analyze", job.payload, id);
  if (!reply.ok() && reply.status().field() == "webhook") {  // the report matters more than the call
    Log(LogLevel::kWarning, "the analysis service calls no webhook", {{"error", reply.status().ToString()}});
    Json without = job.payload;
    without.erase("webhook");
    reply = analysis_.Post("/analyze", without, id);
  }
  if (!reply.ok()) {
    Log(LogLevel::kWarning, "the analysis service did not take a reconstruction",
        {{"job", id}, {"error", reply.status().ToString()}});
    return reply.status();
  }
  return Json{{"accepted", true}};
}

Status ReviveAnnouncements(JobStore& jobs) {
  constexpr int kPage = 1000;
  DRUPE_ASSIGN_OR_RETURN(const JobPage page, jobs.List({kAnnounceKind, "", JobState::kFailed}, kPage, ""));
  for (const Job& job : page.jobs) {
    if (!job.error || job.error->code != "attempts_exhausted") continue;
    const Result<Job> revived = jobs.Retry(job.id);
    if (!revived.ok()) return revived.status();
  }
  return Status::Ok();
}

}  // namespace drupe
