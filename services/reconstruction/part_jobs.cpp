#include "reconstruction/part_jobs.h"

#include <chrono>
#include <thread>
#include <utility>

#include "base/log.h"
#include "reconstruction/pipeline.h"
#include "reconstruction/reconstruct_input.h"
#include "reconstruction/reconstruct_request.h"

namespace drupe {
namespace {

constexpr int kPartPriority = 5;  ///< before whole reconstructions: what is begun is ended first
constexpr int kPartAttempts = 2;
constexpr std::chrono::milliseconds kPartLook{50};

}  // namespace

Result<Json> PartJob::operator()(const Job& job, const RunContext& context) const {
  if (!job.payload.contains("reconstruct")) return InvalidArgument("bad_payload", "no reconstruction", "reconstruct");
  DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest request, FromPayload(job.payload["reconstruct"]));
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOptions options, ParseReconstructionOptions(request.options));
  DRUPE_ASSIGN_OR_RETURN(const std::string part, objects_.Get(job.payload.value("part", "")));
  DRUPE_ASSIGN_OR_RETURN(const std::string result,
                         RunReconstructionPart(job.payload.value("stage", ""), part,
                                               MakeInput(request, objects_, nullptr, limits_), options, context));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  DRUPE_ASSIGN_OR_RETURN(const ObjectInfo stored, objects_.Put(result));
  return Json{{"sha256", stored.sha256}};
}

Result<std::vector<std::string>> PartJobs::Run(const StageParts& parts) {
  std::vector<Offer> offers(parts.parts.size());
  Status outcome = OfferAll(parts, offers);
  if (outcome.ok()) outcome = Finish(parts, offers);
  if (!outcome.ok()) {
    Withdraw(offers);
    return outcome;
  }
  std::vector<std::string> results;
  for (Offer& offer : offers) results.push_back(std::move(offer.result));
  return results;
}

Status PartJobs::OfferAll(const StageParts& parts, std::vector<Offer>& offers) {
  for (std::size_t part = 0; part < offers.size(); ++part) {
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo stored, objects_.Put(parts.parts[part]));
    JobSpec spec;
    spec.kind = kPartKind;
    spec.id_prefix = "part";
    spec.subject = job_.id;
    spec.payload = {{"reconstruct", job_.payload}, {"stage", parts.stage}, {"part", stored.sha256}};
    spec.priority = kPartPriority;
    spec.idempotency_key = "part:" + job_.id + ":" + stored.sha256;
    spec.max_attempts = kPartAttempts;
    const Result<Job> offered = jobs_.Submit(spec);
    if (offered.ok()) offers[part].id = offered->id;  // a queue that is full, or a payload too large: done here
  }
  return Status::Ok();
}

Status PartJobs::Finish(const StageParts& parts, std::vector<Offer>& offers) {
  for (const bool wait : {false, true}) {  // first what is free, then what others still are at
    for (std::size_t part = offers.size(); part-- > 0;) {
      DRUPE_RETURN_IF_ERROR(Take(parts, part, wait, offers[part]));
    }
  }
  return Status::Ok();
}

/// Gets the part's result unless another worker is at it; waits for that one with `wait`.
Status PartJobs::Take(const StageParts& parts, std::size_t part, bool wait, Offer& offer) {
  while (!offer.done) {
    DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
    if (offer.id.empty()) return DoHere(parts, part, offer);
    DRUPE_ASSIGN_OR_RETURN(const Job job, jobs_.Get(offer.id));
    if (job.state == JobState::kSucceeded) {
      Result<std::string> result = objects_.Get(job.result->value("sha256", ""));
      if (!result.ok()) return DoHere(parts, part, offer);
      offer = {job.id, std::move(*result), true};
      parts.done(part);
    } else if (job.state == JobState::kQueued) {
      const Result<Job> mine = jobs_.Cancel(job.id);  // should a worker claim it just now, it stops again
      if (mine.ok()) return DoHere(parts, part, offer);
      if (mine.status().code() != "job_finished") return mine.status();
    } else if (job.state != JobState::kRunning) {
      return DoHere(parts, part, offer);
    } else if (!wait) {
      return Status::Ok();
    } else {
      std::this_thread::sleep_for(kPartLook);
      DRUPE_RETURN_IF_ERROR(jobs_.ExpireLeases().status());  // of a worker that died with it
    }
  }
  return Status::Ok();
}

Status PartJobs::DoHere(const StageParts& parts, std::size_t part, Offer& offer) {
  DRUPE_ASSIGN_OR_RETURN(offer.result, parts.here(part));
  offer.done = true;
  parts.done(part);
  return Status::Ok();
}

void PartJobs::Withdraw(const std::vector<Offer>& offers) {
  for (const Offer& offer : offers) {
    if (offer.id.empty() || offer.done) continue;
    const Result<Job> cancelled = jobs_.Cancel(offer.id);
    if (!cancelled.ok() && cancelled.status().code() != "job_finished") {
      Log(LogLevel::kWarning, "cannot withdraw a part", {{"job", offer.id}, {"error", cancelled.status().ToString()}});
    }
  }
}

}  // namespace drupe
