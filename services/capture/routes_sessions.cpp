#include "capture/routes_sessions.h"

#include <memory>
#include <mutex>
#include <utility>

#include "base/ids.h"
#include "capture/calibration_job.h"
#include "capture/session_grab.h"
#include "http/content.h"
#include "http/method_routes.h"
#include "http/request.h"
#include "http/response.h"
#include "service/job_json.h"

namespace drupe {
namespace {

constexpr std::size_t kMinSessionPictures = 3;
constexpr SteadyCameraOptions kPatience{.patience = std::chrono::seconds(5)};

class SessionRoutes {
 public:
  explicit SessionRoutes(const SessionContext& context) : context_(context) {}

  Status Begin(const Request& request, Response& response) {
    DRUPE_ASSIGN_OR_RETURN(const Json body, ReadJsonBody(request));
    DRUPE_ASSIGN_OR_RETURN(CalibrationSession session, ParseSession(body));
    session.id = NewId("cses");
    DRUPE_RETURN_IF_ERROR(context_.sessions.Put(session));
    response.SetJson(Shown(session), 201);
    response.SetHeader("Location", LinkOf(session.id));
    return Status::Ok();
  }

  Status Get(const Request& request, Response& response) {
    DRUPE_ASSIGN_OR_RETURN(const CalibrationSession session, context_.sessions.Get(request.Capture("id")));
    response.SetJson(Shown(session));
    return Status::Ok();
  }

  Status Take(const Request& request, Response& response) {
    const std::lock_guard lock(mutex_);  // one camera, and each picture is judged by those before
    DRUPE_ASSIGN_OR_RETURN(CalibrationSession session, context_.sessions.Get(request.Capture("id")));
    DRUPE_ASSIGN_OR_RETURN(const Grab grab, TakeSessionPicture(session, context_.capture.objects, kPatience));
    DRUPE_RETURN_IF_ERROR(context_.sessions.Put(session));
    context_.rig.ShowPreview(session.id, grab.preview);
    Json json = ToJson(grab);
    json["session"] = Shown(session);
    response.SetJson(json);
    return Status::Ok();
  }

  Status Finish(const Request& request, Response& response) {
    DRUPE_ASSIGN_OR_RETURN(const CalibrationSession session, context_.sessions.Get(request.Capture("id")));
    if (session.pictures.size() < kMinSessionPictures) {
      return {StatusKind::kConflict, "too_few_images",
              "at least 3 pictures are needed, there are " + std::to_string(session.pictures.size())};
    }
    JobSpec spec{.kind = kCalibrateKind, .id_prefix = "cal"};
    spec.payload = ToJson(session.Request());
    DRUPE_ASSIGN_OR_RETURN(const Job job, context_.capture.jobs.Submit(spec));
    const std::string link = context_.capture.public_url + "/calibrations/" + job.id;
    response.SetJson({{"id", job.id}, {"status", JobStateName(job.state)}, {"links", {{"self", link}}}}, 202);
    response.SetHeader("Location", link);
    return Status::Ok();
  }

  Status Preview(const Request& request, Response& response) {
    DRUPE_ASSIGN_OR_RETURN(const CalibrationSession session, context_.sessions.Get(request.Capture("id")));
    const auto preview = context_.rig.PreviewOf(session.id);
    if (!preview) return NotFound("no_picture_yet", "the session has not taken a picture since the service started");
    response.SetHeader("Cache-Control", "no-store");
    response.SetText(preview->jpeg, "image/jpeg");
    return Status::Ok();
  }

  Status Remove(const Request& request, Response& response) {
    const std::lock_guard lock(mutex_);  // not while a picture is taken, which would bring it back
    DRUPE_RETURN_IF_ERROR(context_.sessions.Get(request.Capture("id")).status());
    DRUPE_RETURN_IF_ERROR(context_.sessions.Remove(request.Capture("id")));
    response.status = 204;
    return Status::Ok();
  }

 private:
  std::string LinkOf(const std::string& id) const {
    return context_.capture.public_url + "/calibration-sessions/" + id;
  }

  Json Shown(const CalibrationSession& session) const {
    const std::string self = LinkOf(session.id);
    Json json = ToJson(session);
    json["links"] = {
        {"self", self}, {"frames", self + "/frames"}, {"preview", self + "/preview.jpg"}, {"finish", self + "/finish"}};
    return json;
  }

  const SessionContext context_;
  std::mutex mutex_;
};

}  // namespace

void AddSessionRoutes(Router& router, const SessionContext& context) {
  const auto add = MethodRoutes(router, std::make_shared<SessionRoutes>(context));
  const RouteOptions plain{.max_body_bytes = 0};
  add("POST", "/calibration-sessions", {}, &SessionRoutes::Begin);
  add("GET", "/calibration-sessions/{id:cses}", plain, &SessionRoutes::Get);
  add("DELETE", "/calibration-sessions/{id:cses}", plain, &SessionRoutes::Remove);
  add("POST", "/calibration-sessions/{id:cses}/frames", {}, &SessionRoutes::Take);
  add("POST", "/calibration-sessions/{id:cses}/finish", {}, &SessionRoutes::Finish);
  add("GET", "/calibration-sessions/{id:cses}/preview.jpg", plain, &SessionRoutes::Preview);
}

}  // namespace drupe
