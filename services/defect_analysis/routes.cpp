#include "defect_analysis/routes.h"

#include <algorithm>
#include <utility>

#include "base/clock.h"
#include "http/content.h"
#include "service/job_json.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxRequestBytes = 1 << 20;
constexpr int kMaxPage = 1000;

Json LinksOf(const std::string& reconstruction, const std::string& public_url) {
  const std::string report = public_url + "/reports/" + reconstruction;
  return {{"report", report}, {"csv", report + ".csv"}, {"artifacts", report + "/artifacts"}};
}

/// An analysis that is not ready.
Json StatusJson(const Job& job, const std::string& public_url) {
  return {{"id", job.subject},
          {"status", JobStateName(job.state)},
          {"stage", job.stage},
          {"progress", job.progress},
          {"links", LinksOf(job.subject, public_url)}};
}

Json EntryJson(const ReportEntry& entry, const std::string& public_url) {
  const auto worst = std::max_element(entry.grades.begin(), entry.grades.end());
  Json grades = Json::array();
  for (const DefectClass grade : entry.grades) grades.push_back(DefectClassName(grade));
  return {{"id", entry.reconstruction},
          {"created_at", FormatUtc(entry.created_ms)},
          {"grade", worst == entry.grades.end() ? Json(nullptr) : Json(DefectClassName(*worst))},
          {"fruit_grades", std::move(grades)},
          {"defects", entry.defects},
          {"links", LinksOf(entry.reconstruction, public_url)}};
}

Result<DefectClass> ParseGrade(std::string_view name) {
  for (const DefectClass grade :
       {DefectClass::kIntact, DefectClass::kRainSpot, DefectClass::kScar, DefectClass::kCrack, DefectClass::kDecay}) {
    if (name == DefectClassName(grade)) return grade;
  }
  return InvalidArgument("invalid_parameter", "grade is one of decay, crack, scar, rain_spot, intact", "grade");
}

struct AnalyzeRequest {
  std::string reconstruction;
  Json options = Json::object();
  std::string webhook;  ///< called when the report is there, or will not be; empty: none
};

Result<AnalyzeRequest> ParseAnalyzeRequest(const Json& json) {
  if (!json.is_object()) return InvalidArgument("invalid_request", "the body must be a JSON object");
  AnalyzeRequest request;
  for (const auto& [key, value] : json.items()) {
    if (key == "reconstruction" && value.is_string()) {
      request.reconstruction = value.get<std::string>();
    } else if (key == "options" && value.is_object()) {
      request.options = value;
    } else if (key == "webhook" && value.is_string()) {
      request.webhook = value.get<std::string>();
    } else if (key == "reconstruction" || key == "options" || key == "webhook") {
      const char* const wanted = key == "options" ? "an object" : key == "webhook" ? "a URL" : "a reconstruction's id";
      return InvalidArgument("invalid_request", key + " must be " + wanted, key);
    } else {
      return InvalidArgument("unknown_option", "there is no option " + key, key);
    }
  }
  if (request.reconstruction.empty()) {
    return InvalidArgument("invalid_request", "the body must name a reconstruction: {\"reconstruction\": \"rec_...\"}",
                           "reconstruction");
  }
  return request;
}

Result<ReportQuery> ParseReportQuery(const Request& request) {
  ReportQuery query;
  DRUPE_ASSIGN_OR_RETURN(const std::int64_t limit, request.QueryInt("limit", query.limit, 1, kMaxPage));
  query.limit = static_cast<int>(limit);
  query.cursor = request.Query("cursor").value_or("");
  if (const auto grade = request.Query("grade")) {
    DRUPE_ASSIGN_OR_RETURN(query.grade, ParseGrade(*grade));
  }
  if (const auto since = request.Query("since")) {
    const Result<std::int64_t> time = ParseUtc(*since);
    if (!time.ok()) return InvalidArgument("invalid_parameter", "since: " + time.status().message(), "since");
    query.since_ms = *time;
  }
  return query;
}

class AnalysisRoutes {
 public:
  AnalysisRoutes(AnalysisService& service, Webhooks& webhooks, std::string public_url)
      : service_(service), webhooks_(webhooks), public_url_(std::move(public_url)) {}

  Status Analyze(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const Json json, ReadJsonBody(request));
    DRUPE_ASSIGN_OR_RETURN(const AnalyzeRequest analyze, ParseAnalyzeRequest(json));
    if (!analyze.webhook.empty()) DRUPE_RETURN_IF_ERROR(webhooks_.Check(analyze.webhook));
    DRUPE_ASSIGN_OR_RETURN(const Job job, service_.Analyze(analyze.reconstruction, analyze.options));
    if (!analyze.webhook.empty()) DRUPE_RETURN_IF_ERROR(webhooks_.Subscribe(job.id, analyze.webhook));
    response.SetHeader("Location", public_url_ + "/reports/" + job.subject);
    response.SetJson(StatusJson(job, public_url_), 202);
    return Status::Ok();
  }

  Status GetReport(const Request& request, Response& response, ReportFormat format) const {
    DRUPE_ASSIGN_OR_RETURN(const AnalysisState state, service_.Find(request.Capture("id")));
    if (!IsTerminal(state.job.state)) {
      response.SetHeader("Retry-After", "1");
      response.SetJson(StatusJson(state.job, public_url_), 202);
      return Status::Ok();
    }
    if (!state.report) return ErrorOfEndedJob(state.job);
    DRUPE_ASSIGN_OR_RETURN(std::string bytes, service_.Read(*state.report, format));
    const bool json = format == ReportFormat::kJson;
    SendContent(request, MakeByteSource(std::move(bytes)), json ? "application/json" : "text/csv; charset=utf-8",
                json ? state.report->json_sha256 : state.report->csv_sha256, response);
    return Status::Ok();
  }

  Status ListArtifacts(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const AnalysisState state, service_.Find(request.Capture("id")));
    response.SetJson({{"artifacts", ToJson(ArtifactsOf(state))}});
    return Status::Ok();
  }

  Status GetArtifact(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const AnalysisState state, service_.Find(request.Capture("id")));
    return service_.SendArtifact(request, state, response);
  }

  Status ListReports(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const ReportQuery query, ParseReportQuery(request));
    DRUPE_ASSIGN_OR_RETURN(const ReportPage page, service_.List(query));
    Json reports = Json::array();
    for (const ReportEntry& entry : page.reports) reports.push_back(EntryJson(entry, public_url_));
    const Json next = page.next_cursor.empty() ? Json(nullptr) : Json(page.next_cursor);
    response.SetJson({{"reports", std::move(reports)}, {"next_cursor", next}});
    return Status::Ok();
  }

 private:
  AnalysisService& service_;
  Webhooks& webhooks_;
  const std::string public_url_;
};

/// A handler that answers with the error when `answer` returns one.
template <typename Answer>
Handler Answering(Answer answer) {
  return [answer](const Request& request, Response& response) {
    if (const Status status = answer(request, response); !status.ok()) response.SetError(status);
  };
}

}  // namespace

Json DescribeAnalysis(const Job& job, const std::string& public_url) {
  Json body = StatusJson(job, public_url);
  body["event"] = std::string("report.") + JobStateName(job.state);
  body["error"] = JobErrorJson(job);
  return body;
}

void AddAnalysisRoutes(AnalysisService& service, Webhooks& webhooks, const std::string& public_url, Router& router) {
  const auto routes = std::make_shared<AnalysisRoutes>(service, webhooks, public_url);
  const RouteOptions with_body{.max_body_bytes = kMaxRequestBytes};
  const RouteOptions without_body{.max_body_bytes = 0};
  router.Add("POST", "/analyze", with_body, Answering([routes](const Request& request, Response& response) {
               return routes->Analyze(request, response);
             }));
  router.Add("GET", "/reports", without_body, Answering([routes](const Request& request, Response& response) {
               return routes->ListReports(request, response);
             }));
  router.Add("GET", "/reports/{id:rec}.csv", without_body,
             Answering([routes](const Request& request, Response& response) {
               return routes->GetReport(request, response, ReportFormat::kCsv);
             }));
  router.Add("GET", "/reports/{id:rec}", without_body, Answering([routes](const Request& request, Response& response) {
               return routes->GetReport(request, response, ReportFormat::kJson);
             }));
  router.Add("GET", "/reports/{id:rec}/artifacts", without_body,
             Answering([routes](const Request& request, Response& response) {
               return routes->ListArtifacts(request, response);
             }));
  router.Add("GET", "/reports/{id:rec}/artifacts/{name}", without_body,
             Answering([routes](const Request& request, Response& response) {
               return routes->GetArtifact(request, response);
             }));
}

}  // namespace drupe
