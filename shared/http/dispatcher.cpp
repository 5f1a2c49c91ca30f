#include "http/dispatcher.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <utility>

#include "base/log.h"
#include "base/trace.h"
#include "http/admission.h"

namespace drupe {

namespace {

Response ErrorResponse(const Status& error) {
  Response response;
  response.SetError(error);
  return response;
}

/// That the audit log has even of a request that only reads.
bool IsRefusal(int http_status) {
  return http_status == 401 || http_status == 403 || http_status == 429;
}

/// What the client learns of an exception: nothing but the id under which the log has it.
Response AfterException(const Request& request, std::string_view what) {
  Log(LogLevel::kError, "a handler threw", {{"request", request.id}, {"route", request.route}, {"what", what}});
  return ErrorResponse(Internal("internal", "the server failed on this request; its log names request " + request.id));
}

}  // namespace

namespace {

/// A client that names its request finds the name in every log from here to the report.
void AdoptTrace(const RequestHead& head, Request& request) {
  const auto name = head.headers.find("X-Request-Id");
  if (name != head.headers.end() && IsTrace(name->second)) request.id = name->second;
}

}  // namespace

Status ServerBusy(std::string_view why) {
  return Status(StatusKind::kUnavailable, "server_busy", std::string(why) + "; try again later");
}

Response Dispatcher::Answer(Result<RequestHead> head, bool reserved_only, Request& request) {
  const Stopwatch watch;
  if (head.ok()) AdoptTrace(*head, request);
  const TraceScope trace(request.id);
  Response response = head.ok() ? Dispatch(*head, reserved_only, request) : ErrorResponse(head.status());
  response.SetHeader("X-Request-Id", request.id);
  Record(request, response, watch);
  return response;
}

Response Dispatcher::Dispatch(RequestHead& head, bool reserved_only, Request& request) {
  request.method = head.method == "HEAD" ? "GET" : head.method;
  request.path = head.path;
  request.headers = std::move(head.headers);
  std::string allowed;
  const Result<const Router::Route*> route = router_.Find(head.method, head.path, request, allowed);
  if (!route.ok()) {
    Response response = ErrorResponse(route.status());
    if (!allowed.empty()) response.SetHeader("Allow", allowed);
    return response;
  }
  Result<std::map<std::string, std::string, std::less<>>> query = ParseQuery(head.query);
  if (!query.ok()) return ErrorResponse(query.status());
  request.query = std::move(*query);
  const Status admitted = Admit((*route)->options, head.content_length, reserved_only);
  return admitted.ok() ? RunWithPass(**route, request) : ErrorResponse(admitted);
}

Response Dispatcher::RunWithPass(const Router::Route& route, Request& request) {
  Scope scope = route.options.scope;
  if (scope == Scope::kByMethod) scope = request.method == "GET" ? Scope::kRead : Scope::kSubmit;
  if (options_.access == nullptr || scope == Scope::kNone) return Run(route, request);
  const Result<AccessControl::Pass> pass = options_.access->Admit(request.Header("Authorization"), scope);
  if (pass.ok()) {
    request.caller = pass->name();
    return Run(route, request);
  }
  Response response = ErrorResponse(pass.status());
  if (response.status == 401) response.SetHeader("WWW-Authenticate", "Bearer");
  return response;
}

Status Dispatcher::Admit(const RouteOptions& route, std::uint64_t content_length, bool reserved_only) const {
  if (reserved_only && !route.reserved) return ServerBusy("every connection is taken");
  const std::uint64_t limit = std::min(route.max_body_bytes, options_.max_body_bytes);
  if (content_length <= limit) return Status::Ok();
  return Status(StatusKind::kTooLarge, "body_too_large",
                "the body has " + std::to_string(content_length) + " bytes; the limit here is " + std::to_string(limit),
                "Content-Length");
}

Response Dispatcher::Run(const Router::Route& route, const Request& request) {
  std::optional<Admission> upload;
  if (route.options.upload) upload.emplace(uploads_, options_.max_concurrent_uploads);
  if (upload && !upload->admitted()) return ErrorResponse(ServerBusy("too many uploads are under way"));
  Response response;
  try {
    route.handler(request, response);
  } catch (const std::exception& error) {
    return AfterException(request, error.what());
  } catch (...) {
    return AfterException(request, "not a std::exception");
  }
  if (response.events) HoldEventStream(response);
  return response;
}

/// Lets the stream hold one of the limited places for as long as it is produced.
void Dispatcher::HoldEventStream(Response& response) {
  auto place = std::make_shared<Admission>(event_streams_, options_.max_event_streams);
  if (!place->admitted()) return response.SetError(ServerBusy("too many event streams are open"));
  response.events = [place, producer = std::move(response.events)](EventSink& sink) { return producer(sink); };
}

void Dispatcher::Record(const Request& request, const Response& response, const Stopwatch& watch) const {
  const std::string route = request.route.empty() ? "none" : request.route;
  const std::string method = request.route.empty() ? "none" : request.method;
  const LogLevel level = response.status >= 500 && response.status != 503 ? LogLevel::kWarning : LogLevel::kDebug;
  Log(level, "request",
      {{"request", request.id},
       {"method", method},
       {"path", request.path},
       {"status", response.status},
       {"from", request.remote_address},
       {"wall_s", watch.WallSeconds()}});
  if (options_.access != nullptr && (request.method != "GET" || IsRefusal(response.status))) {
    Log(LogLevel::kInfo, "audit",
        {{"request", request.id},
         {"caller", request.caller},
         {"method", method},
         {"path", request.path},
         {"status", response.status},
         {"from", request.remote_address}});
  }
  if (metrics_ == nullptr) return;
  metrics_->Count("drupe_http_requests_total", "Requests answered.",
                  {{"method", method}, {"route", route}, {"status", std::to_string(response.status)}});
  metrics_->ObserveSeconds("drupe_http_request_seconds", "From a request's head to the start of its reply.",
                           {{"method", method}, {"route", route}}, watch.WallSeconds());
}

}  // namespace drupe
