#include "capture/routes_scans.h"

#include <memory>
#include <utility>

#include "capture/calibration_job.h"
#include "capture/scan_job.h"
#include "capture/scan_request.h"
#include "http/content.h"
#include "http/method_routes.h"
#include "http/request.h"
#include "http/response.h"
#include "scene/calibration.h"
#include "service/job_json.h"
#include "service/job_page.h"

namespace drupe {
namespace {

constexpr int kScanAttempts = 20;  // each goes on where the one before ended

class ScanRoutes {
 public:
  explicit ScanRoutes(const ScanContext& context) : context_(context) {}

  Status Submit(const Request& request, Response& response) const {
    JobSpec spec{.kind = kScanKind, .id_prefix = "scan", .max_attempts = kScanAttempts};
    DRUPE_ASSIGN_OR_RETURN(spec.idempotency_key, ReadIdempotencyKey(request));
    DRUPE_ASSIGN_OR_RETURN(Json body, ReadJsonBody(request));
    DRUPE_RETURN_IF_ERROR(ResolveCalibration(body));
    DRUPE_ASSIGN_OR_RETURN(const ScanRequest asked, ParseScanRequest(body));
    DRUPE_RETURN_IF_ERROR(CheckCalibration(asked));
    spec.payload = ToJson(asked);
    DRUPE_ASSIGN_OR_RETURN(const Job job, jobs().Submit(spec));
    DRUPE_ASSIGN_OR_RETURN(const Json json, Summary(job));
    response.SetJson(json, 202);
    response.SetHeader("Location", LinkOf(job.id));
    return Status::Ok();
  }

  Status List(const Request& request, Response& response) const {
    const auto describe = [this](const Job& job) { return Summary(job); };
    DRUPE_ASSIGN_OR_RETURN(const Json page, JobPageJson(request, jobs(), kScanKind, "scans", describe));
    response.SetJson(page);
    return Status::Ok();
  }

  Status Get(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const Job job, Find(request));
    DRUPE_ASSIGN_OR_RETURN(Json json, Summary(job));
    json["request"] = job.payload;
    json["frames"] = Json::array();
    DRUPE_ASSIGN_OR_RETURN(const std::vector<ScanFrame> frames, context_.scans.Frames(job.id));
    for (const ScanFrame& frame : frames) {
      Json entry = ToJson(frame);
      entry["href"] = LinkOf(job.id) + "/frames/" + frame.name;
      json["frames"].push_back(std::move(entry));
    }
    response.SetJson(json);
    return Status::Ok();
  }

  Status Cancel(const Request& request, Response& response) const {
    DRUPE_RETURN_IF_ERROR(Find(request).status());
    DRUPE_ASSIGN_OR_RETURN(const Job job, jobs().Cancel(request.Capture("id")));
    DRUPE_ASSIGN_OR_RETURN(const Json json, Summary(job));
    response.SetJson(json, job.state == JobState::kCancelled ? 200 : 202);
    return Status::Ok();
  }

  Status Resume(const Request& request, Response& response) const {
    DRUPE_RETURN_IF_ERROR(Find(request).status());
    DRUPE_ASSIGN_OR_RETURN(const Job before, jobs().Get(request.Capture("id")));
    if (before.state == JobState::kSucceeded) {
      return {StatusKind::kConflict, "scan_complete", "the scan has all its views; there is nothing to resume"};
    }
    DRUPE_RETURN_IF_ERROR(context_.scans.Reopen(before.id));
    DRUPE_ASSIGN_OR_RETURN(const Job job, jobs().Retry(before.id));
    DRUPE_ASSIGN_OR_RETURN(const Json json, Summary(job));
    response.SetJson(json, 202);
    return Status::Ok();
  }

  Status Follow(const Request& request, Response& response) const {
    DRUPE_RETURN_IF_ERROR(Find(request).status());
    auto last = std::make_shared<std::string>();
    response.SetEvents([this, id = request.Capture("id"), last](EventSink& sink) {
      const Result<Job> job = jobs().Get(id);
      const Result<Json> json = job.ok() ? Summary(*job) : Result<Json>(job.status());
      if (!json.ok()) return false;
      std::string text = DumpJson(*json);
      if (text != *last && !sink.Send("status", *json)) return false;
      *last = std::move(text);
      const bool handed_over = json->at("hand_over").at("ended").get<bool>();
      return !IsTerminal(job->state) || (job->state == JobState::kSucceeded && !handed_over);
    });
    return Status::Ok();
  }

  Status Preview(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const Job job, Find(request));
    response.SetHeader("Cache-Control", "no-store");
    if (const auto preview = context_.rig.PreviewOf(job.id)) {
      response.SetText(preview->jpeg, "image/jpeg");
      return Status::Ok();
    }
    DRUPE_ASSIGN_OR_RETURN(const std::vector<ScanFrame> frames, context_.scans.Frames(job.id));
    if (frames.empty()) return NotFound("no_picture_yet", "the scan has not taken a picture yet");
    DRUPE_ASSIGN_OR_RETURN(std::string jpeg, context_.capture.objects.Get(frames.back().sha256));
    response.SetText(std::move(jpeg), "image/jpeg");
    return Status::Ok();
  }

  /// Each picture that the scan takes, from the latest on; who reads slowly misses some. Ends with the scan.
  Status Watch(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const Job job, Find(request));
    auto shown = std::make_shared<std::int64_t>(0);
    response.SetStream("multipart/x-mixed-replace; boundary=frame", [this, id = job.id, shown](StreamSink& sink) {
      const auto preview = context_.rig.PreviewOf(id, *shown);
      if (preview) {
        *shown = preview->number;
        const std::string head = "--frame\r\nContent-Type: image/jpeg\r\nContent-Length: ";
        if (!sink.Write(head + std::to_string(preview->jpeg.size()) + "\r\n\r\n" + preview->jpeg + "\r\n"))
          return false;
      }
      const Result<Job> now = jobs().Get(id);
      if (now.ok() && !IsTerminal(now->state)) return true;
      sink.Write("--frame--\r\n");
      return false;
    });
    return Status::Ok();
  }

  Status GetFrame(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const Job job, Find(request));
    DRUPE_ASSIGN_OR_RETURN(const std::vector<ScanFrame> frames, context_.scans.Frames(job.id));
    for (const ScanFrame& frame : frames) {
      if (frame.name != request.Capture("name")) continue;
      DRUPE_ASSIGN_OR_RETURN(std::string jpeg, context_.capture.objects.Get(frame.sha256));
      SendContent(request, MakeByteSource(std::move(jpeg)), "image/jpeg", frame.sha256, response);
      return Status::Ok();
    }
    return NotFound("frame_not_found", "the scan has no frame " + request.Capture("name"));
  }

  Status StopTable(const Request&, Response& response) const {
    response.SetJson({{"stopped", context_.rig.EmergencyStop()}});
    return Status::Ok();
  }

 private:
  JobStore& jobs() const { return context_.capture.jobs; }
  std::string LinkOf(const std::string& id) const { return context_.capture.public_url + "/scans/" + id; }

  Result<Job> Find(const Request& request) const {
    DRUPE_ASSIGN_OR_RETURN(Job job, jobs().Get(request.Capture("id")));
    if (job.kind == kScanKind) return job;
    return NotFound("scan_not_found", "there is no scan " + job.id);
  }

  /// A calibration may be named by its id, or its job's: the scan keeps its content, and what it was made with.
  Status ResolveCalibration(Json& body) const {
    if (!body.is_object()) return Status::Ok();
    body.erase("calibrated_for");
    if (!body.contains("calibration") || !body["calibration"].is_string()) return Status::Ok();
    const auto id = body["calibration"].get<std::string>();
    const Result<StoredCalibration> stored = context_.capture.calibrations.Get(id);
    if (!stored.ok()) {
      const Result<Job> job = jobs().Get(id);
      return job.ok() && job->kind == kCalibrateKind ? CalibrationNotReady(*job) : stored.status();
    }
    body["calibration"] = stored->calibration;
    body["calibrated_for"] = ToJson(stored->binding);
    return Status::Ok();
  }

  /// Refuses at once what the scan would refuse when it opens the camera, as far as it is known now.
  Status CheckCalibration(const ScanRequest& asked) const {
    if (asked.calibration.is_null()) return Status::Ok();
    CameraBinding used{"", asked.lens};
    if (!asked.calibrated_for.serial.empty()) used.serial = SerialOf(asked.camera_id);
    DRUPE_RETURN_IF_ERROR(CheckBinding(asked.calibrated_for, used));
    const CameraRegion& region = asked.camera.region;
    if (region.width == 0 || region.height == 0) return Status::Ok();
    DRUPE_ASSIGN_OR_RETURN(const Calibration calibration, ParseCalibration(asked.calibration));
    return CheckCalibrationSize(calibration, region.width, region.height);
  }

  /// Of a camera that answers now; empty when it does not.
  std::string SerialOf(const std::string& camera_id) const {
    const Result<std::vector<CameraInfo>> cameras = context_.capture.cameras.List();
    if (!cameras.ok()) return "";
    for (const CameraInfo& camera : *cameras) {
      const bool is_only_one = camera_id.empty() && cameras->size() == 1;
      if (is_only_one || camera.id == camera_id || camera.address == camera_id) return camera.serial;
    }
    return "";
  }

  Json HandOverJson(const ScanRecord& record, const std::vector<ScanFrame>& frames) const {
    const auto text = [](const std::string& value) { return value.empty() ? Json() : Json(value); };
    std::int64_t sent = 0;
    for (const ScanFrame& frame : frames) sent += frame.sent ? 1 : 0;
    const std::string& url = context_.capture.reconstruction_url;
    return {{"image_set", text(record.image_set)},
            {"frames", sent},
            {"reconstruction", text(record.job)},
            {"link", record.job.empty() ? Json() : Json(url + "/reconstructions/" + record.job)},
            {"error", text(record.hand_over_error)},
            {"ended", record.ended}};
  }

  Json LinksJson(const std::string& id) const {
    const std::string self = LinkOf(id);
    return {{"self", self},
            {"events", self + "/events"},
            {"preview", self + "/preview.jpg"},
            {"live", self + "/preview.mjpeg"}};
  }

  Result<Json> Summary(const Job& job) const {
    Result<ScanRecord> record = context_.scans.Get(job.id);
    if (!record.ok() && record.status().kind() != StatusKind::kNotFound) return record.status();
    const ScanRecord known = record.ok() ? *record : ScanRecord();
    DRUPE_ASSIGN_OR_RETURN(const std::vector<ScanFrame> frames, context_.scans.Frames(job.id));
    Json json = JobJson(job);
    json["mode"] = job.payload.value("mode", Json());
    json["views"] = job.payload.value("views", Json());
    json["taken"] = frames.size();
    json["camera"] = known.camera;
    json["counters"] = known.counters;
    json["hand_over"] = HandOverJson(known, frames);
    json["seconds_from_last_shutter"] = known.timings;
    json["links"] = LinksJson(job.id);
    return json;
  }

  const ScanContext context_;
};

}  // namespace

void AddScanRoutes(Router& router, const ScanContext& context) {
  const auto add = MethodRoutes(router, std::make_shared<ScanRoutes>(context));
  const RouteOptions plain{.max_body_bytes = 0};
  add("POST", "/scans", {}, &ScanRoutes::Submit);
  add("GET", "/scans", plain, &ScanRoutes::List);
  add("GET", "/scans/{id:scan}", plain, &ScanRoutes::Get);
  add("DELETE", "/scans/{id:scan}", plain, &ScanRoutes::Cancel);
  add("POST", "/scans/{id:scan}/resume", {}, &ScanRoutes::Resume);
  add("GET", "/scans/{id:scan}/events", plain, &ScanRoutes::Follow);
  add("GET", "/scans/{id:scan}/preview.jpg", plain, &ScanRoutes::Preview);
  add("GET", "/scans/{id:scan}/preview.mjpeg", plain, &ScanRoutes::Watch);
  add("GET", "/scans/{id:scan}/frames/{name}", plain, &ScanRoutes::GetFrame);
  add("POST", "/turntable/stop", {.reserved = true}, &ScanRoutes::StopTable);
}

}  // namespace drupe
