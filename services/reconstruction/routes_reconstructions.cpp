#include <optional>
#include <vector>

#include "http/request.h"
#include "http/response.h"
#include "reconstruction/reconstruct_job.h"
#include "reconstruction/reconstruct_request.h"
#include "reconstruction/routes.h"
#include "service/artifacts.h"
#include "service/job_json.h"
#include "service/job_page.h"

namespace drupe {

namespace {

Result<ReconstructRequest> ReadRequest(const RouteContext& context, const Request& request) {
  if (request.HasMediaType("multipart/form-data")) {
    return ReadReconstructForm(request, context.objects, context.sets, context.limits);
  }
  if (request.HasMediaType("application/json")) return ReadReconstructJson(request, context.sets, context.limits);
  return Status(StatusKind::kUnsupportedMedia, "unsupported_media_type",
                "send multipart/form-data with the images, or application/json with the id of an image set",
                "Content-Type");
}

Result<Job> SubmitRequest(const RouteContext& context, const Request& request) {
  JobSpec spec;
  DRUPE_ASSIGN_OR_RETURN(const std::string key, ReadIdempotencyKey(request));
  DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest asked, ReadRequest(context, request));
  if (!asked.webhook.empty()) DRUPE_RETURN_IF_ERROR(context.webhooks.Check(asked.webhook));
  if (!key.empty()) spec.idempotency_key = "client:" + key;  // never one that this service makes for itself
  spec.kind = kReconstructKind;
  spec.id_prefix = "rec";
  spec.subject = asked.image_set;
  spec.payload = ToPayload(asked);
  DRUPE_ASSIGN_OR_RETURN(Job job, context.jobs.Submit(spec));
  if (!asked.webhook.empty()) DRUPE_RETURN_IF_ERROR(context.webhooks.Subscribe(job.id, asked.webhook));
  return job;
}

void Submit(const RouteContext& context, const Request& request, Response& response) {
  const Result<Job> job = SubmitRequest(context, request);
  if (!job.ok()) return response.SetError(job.status());
  response.SetJson(SummaryJson(*job, context.links), 202);
  response.SetHeader("Location", context.links.self + "/reconstructions/" + job->id);
}

void GetStatus(const RouteContext& context, const Request& request, Response& response) {
  const Result<Job> job = context.jobs.Get(request.Capture("id"));
  if (!job.ok()) return response.SetError(job.status());
  response.SetJson(StatusJson(*job, context.links));
}

void List(const RouteContext& context, const Request& request, Response& response) {
  const auto describe = [&](const Job& job) -> Result<Json> { return SummaryJson(job, context.links); };
  const Result<Json> list = JobPageJson(request, context.jobs, kReconstructKind, "reconstructions", describe);
  if (!list.ok()) return response.SetError(list.status());
  response.SetJson(*list);
}

void Cancel(const RouteContext& context, const Request& request, Response& response) {
  const Result<Job> job = context.jobs.Cancel(request.Capture("id"));
  if (!job.ok()) return response.SetError(job.status());
  response.SetJson(SummaryJson(*job, context.links), IsTerminal(job->state) ? 200 : 202);
}

/// Sends the status whenever it has changed, up to the end of the job.
class StatusEvents {
 public:
  StatusEvents(const RouteContext& context, std::string id) : context_(context), id_(std::move(id)) {}

  bool operator()(EventSink& sink) {
    const std::uint64_t version = context_.jobs.changes().version();
    if (seen_ == version) return true;
    seen_ = version;
    const Result<Job> job = context_.jobs.Get(id_);
    if (!job.ok()) return false;
    const Json status = SummaryJson(*job, context_.links);
    if (status != last_ && !sink.Send("status", status)) return false;
    last_ = status;
    return !IsTerminal(job->state);
  }

 private:
  RouteContext context_;
  std::string id_;
  std::optional<std::uint64_t> seen_;
  Json last_;
};

void Events(const RouteContext& context, const Request& request, Response& response) {
  const Result<Job> job = context.jobs.Get(request.Capture("id"));
  if (!job.ok()) return response.SetError(job.status());
  response.SetEvents(StatusEvents(context, job->id));
}

std::vector<Artifact> ArtifactsOf(const Job& job) {
  return job.result ? ParseArtifacts(job.result->value("artifacts", Json::array())) : std::vector<Artifact>();
}

void GetArtifact(const RouteContext& context, const Request& request, Response& response) {
  const Result<Job> job = context.jobs.Get(request.Capture("id"));
  if (!job.ok()) return response.SetError(job.status());
  const Status sent = SendArtifact(request, *job, ArtifactsOf(*job), context.objects, response);
  if (!sent.ok()) response.SetError(sent);
}

void ListArtifacts(const RouteContext& context, const Request& request, Response& response) {
  const Result<Job> job = context.jobs.Get(request.Capture("id"));
  if (!job.ok()) return response.SetError(job.status());
  response.SetJson({{"artifacts", ToJson(ArtifactsOf(*job))}});
}

}  // namespace

void AddReconstructionRoutes(Router& router, const RouteContext& context) {
  const auto bind = [context](auto function) {
    return [context, function](const Request& request, Response& response) { function(context, request, response); };
  };
  const RouteOptions upload{.max_body_bytes = context.limits.max_request_bytes, .upload = true};
  router.Add("POST", "/reconstruct", upload, bind(Submit));
  router.Add("GET", "/reconstructions", {}, bind(List));
  router.Add("GET", "/reconstructions/{id:rec}", {}, bind(GetStatus));
  router.Add("DELETE", "/reconstructions/{id:rec}", {}, bind(Cancel));
  router.Add("GET", "/reconstructions/{id:rec}/events", {}, bind(Events));
  router.Add("GET", "/reconstructions/{id:rec}/artifacts", {}, bind(ListArtifacts));
  router.Add("GET", "/reconstructions/{id:rec}/artifacts/{name}", {}, bind(GetArtifact));
}

}  // namespace drupe
