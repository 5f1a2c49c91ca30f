#include "service/job_routes.h"

#include <functional>

#include "base/clock.h"
#include "service/job_json.h"

namespace drupe {

namespace {

constexpr int kPage = 100;
constexpr int kMaxPage = 1000;

Json ErrorJson(const std::optional<JobError>& error) {
  if (!error) return nullptr;
  return {{"code", error->code}, {"message", error->message}};
}

Json OperatorJobJson(const Job& job) {
  Json json = JobJson(job);
  json["kind"] = job.kind;
  json["subject"] = job.subject;
  json["priority"] = job.priority;
  json["attempt"] = job.attempt;
  json["failures"] = job.failures;
  json["max_attempts"] = job.max_attempts;
  json["worker"] = job.worker;
  json["trace"] = job.trace;
  json["error"] = ErrorJson(job.error);
  return json;
}

Json HistoryJson(const std::vector<JobEvent>& events) {
  Json list = Json::array();
  for (const JobEvent& event : events) {
    list.push_back({{"at", FormatUtc(event.at_ms)},
                    {"status", JobStateName(event.state)},
                    {"attempt", event.attempt},
                    {"worker", event.worker},
                    {"reason", event.reason}});
  }
  return list;
}

Result<Json> List(JobStore& jobs, const Request& request) {
  JobFilter filter{.kind = request.Query("kind").value_or(""), .subject = request.Query("subject").value_or("")};
  if (const auto state = request.Query("state")) {
    DRUPE_ASSIGN_OR_RETURN(filter.state, ParseJobState(*state));
  }
  DRUPE_ASSIGN_OR_RETURN(const std::int64_t limit, request.QueryInt("limit", kPage, 1, kMaxPage));
  DRUPE_ASSIGN_OR_RETURN(const JobPage page,
                         jobs.List(filter, static_cast<int>(limit), request.Query("cursor").value_or("")));
  Json list = Json::array();
  for (const Job& job : page.jobs) list.push_back(OperatorJobJson(job));
  return Json{{"jobs", list}, {"next_cursor", page.next_cursor.empty() ? Json(nullptr) : Json(page.next_cursor)}};
}

Result<Json> Show(JobStore& jobs, const Request& request) {
  DRUPE_ASSIGN_OR_RETURN(const Job job, jobs.Get(request.Capture("id")));
  DRUPE_ASSIGN_OR_RETURN(const std::vector<JobEvent> events, jobs.History(job.id));
  Json json = OperatorJobJson(job);
  json["history"] = HistoryJson(events);
  return json;
}

Result<Json> Changed(Result<Job> job) {
  if (!job.ok()) return job.status();
  return OperatorJobJson(*job);
}

using JobAnswer = std::function<Result<Json>(JobStore&, const Request&)>;

Handler Reply(JobStore& jobs, JobAnswer answer) {
  return [&jobs, answer = std::move(answer)](const Request& request, Response& response) {
    const Result<Json> json = answer(jobs, request);
    json.ok() ? response.SetJson(*json) : response.SetError(json.status());
  };
}

}  // namespace

void AddJobRoutes(Router& router, JobStore& jobs) {
  router.Add("GET", "/jobs", {.max_body_bytes = 0}, Reply(jobs, List));
  router.Add("GET", "/jobs/{id}", {.max_body_bytes = 0}, Reply(jobs, Show));
  router.Add(
      "POST", "/jobs/{id}/retry", {.max_body_bytes = 0, .scope = Scope::kAdmin},
      Reply(jobs, [](JobStore& store, const Request& request) { return Changed(store.Retry(request.Capture("id"))); }));
  router.Add("POST", "/jobs/{id}/cancel", {.max_body_bytes = 0, .scope = Scope::kAdmin},
             Reply(jobs, [](JobStore& store, const Request& request) {
               return Changed(store.Cancel(request.Capture("id")));
             }));
}

}  // namespace drupe
