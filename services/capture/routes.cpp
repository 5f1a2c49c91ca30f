#include "capture/routes.h"

#include <utility>

#include "base/digest.h"
#include "capture/calibration_job.h"
#include "capture/calibration_request.h"
#include "http/content.h"
#include "http/method_routes.h"
#include "http/request.h"
#include "http/response.h"
#include "service/job_json.h"
#include "service/job_page.h"

namespace drupe {
namespace {

class CaptureRoutes {
 public:
  explicit CaptureRoutes(const CaptureContext& context) : context_(context) {}

  Status ListCameras(const Request&, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const std::vector<CameraInfo> cameras, context_.cameras.List());
    Json list = Json::array();
    for (const CameraInfo& camera : cameras) {
      list.push_back({{"id", camera.id},
                      {"model", camera.model},
                      {"serial", camera.serial},
                      {"vendor", camera.vendor},
                      {"address", camera.address},
                      {"protocol", camera.protocol}});
    }
    response.SetJson({{"cameras", std::move(list)}});
    return Status::Ok();
  }

  Status Submit(const Request& request, Response& response) const {
    JobSpec spec{.kind = kCalibrateKind, .id_prefix = "cal"};
    DRUPE_ASSIGN_OR_RETURN(spec.idempotency_key, ReadIdempotencyKey(request));
    DRUPE_ASSIGN_OR_RETURN(const CalibrationRequest asked,
                           ReadCalibrationForm(request, context_.objects, context_.limits));
    spec.payload = ToJson(asked);
    DRUPE_ASSIGN_OR_RETURN(const Job job, context_.jobs.Submit(spec));
    response.SetJson(SummaryJson(job), 202);
    response.SetHeader("Location", LinkOf(job));
    return Status::Ok();
  }

  Status Get(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const Job job, Find(request.Capture("id")));
    Json json = SummaryJson(job);
    json["pattern"] = job.payload.value("pattern", Json());
    json["refused_images"] = job.payload.value("refused_images", Json::array());
    json["result"] = job.result.value_or(Json());
    response.SetJson(json);
    return Status::Ok();
  }

  Status GetFile(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const StoredCalibration stored, Stored(request));
    std::string text = DumpJson(stored.calibration, 1) + "\n";
    const std::string digest = Sha256Hex(text);
    SendContent(request, MakeByteSource(std::move(text)), "application/json", digest, response);
    return Status::Ok();
  }

  Status GetCoverage(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const StoredCalibration stored, Stored(request));
    DRUPE_ASSIGN_OR_RETURN(std::string png, context_.objects.Get(stored.coverage_sha256));
    SendContent(request, MakeByteSource(std::move(png)), "image/png", stored.coverage_sha256, response);
    return Status::Ok();
  }

  Status List(const Request& request, Response& response) const {
    const auto describe = [this](const Job& job) { return Result<Json>(SummaryJson(job)); };
    DRUPE_ASSIGN_OR_RETURN(const Json page,
                           JobPageJson(request, context_.jobs, kCalibrateKind, "calibrations", describe));
    response.SetJson(page);
    return Status::Ok();
  }

 private:
  /// The job of a calibration's own id, or of its job's.
  Result<Job> Find(const std::string& id) const {
    const Result<StoredCalibration> stored = context_.calibrations.Get(id);
    return context_.jobs.Get(stored.ok() ? stored->job : id);
  }

  Result<StoredCalibration> Stored(const Request& request) const {
    const std::string id = request.Capture("id");
    Result<StoredCalibration> stored = context_.calibrations.Get(id);
    if (stored.ok() || stored.status().kind() != StatusKind::kNotFound) return stored;
    DRUPE_ASSIGN_OR_RETURN(const Job job, context_.jobs.Get(id));
    return CalibrationNotReady(job);
  }

  std::string LinkOf(const Job& job) const { return context_.public_url + "/calibrations/" + job.id; }

  Json LinksJson(const Job& job) const {
    Json links = {{"self", LinkOf(job)}};
    if (job.state == JobState::kSucceeded) {
      links["calibration"] = LinkOf(job) + "/calibration.json";
      links["coverage"] = LinkOf(job) + "/coverage.png";
      links["reconstruct"] = context_.reconstruction_url + "/reconstruct";
    }
    return links;
  }

  Json SummaryJson(const Job& job) const {
    const Json result = job.result.value_or(Json::object());
    Json json = JobJson(job);
    json["calibration_id"] = result.value("id", Json());
    json["camera"] = job.payload.value("camera", Json());
    json["images"] = job.payload.value("images", Json::array()).size();
    json["grade"] = result.value("grade", Json());
    json["verdict"] = result.value("verdict", Json());
    json["links"] = LinksJson(job);
    return json;
  }

  const CaptureContext context_;
};

}  // namespace

void AddCaptureRoutes(Router& router, const CaptureContext& context) {
  const auto add = MethodRoutes(router, std::make_shared<CaptureRoutes>(context));
  const RouteOptions plain{.max_body_bytes = 0};
  const RouteOptions upload{.max_body_bytes = context.limits.max_request_bytes, .upload = true};
  add("GET", "/cameras", plain, &CaptureRoutes::ListCameras);
  add("POST", "/calibrations", upload, &CaptureRoutes::Submit);
  add("GET", "/calibrations", plain, &CaptureRoutes::List);
  add("GET", "/calibrations/{id:cal}", plain, &CaptureRoutes::Get);
  add("GET", "/calibrations/{id:cal}/calibration.json", plain, &CaptureRoutes::GetFile);
  add("GET", "/calibrations/{id:cal}/coverage.png", plain, &CaptureRoutes::GetCoverage);
}

}  // namespace drupe
