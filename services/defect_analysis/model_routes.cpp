#include "defect_analysis/model_routes.h"

#include <memory>
#include <utility>

#include "defect_analysis/models/default_model.h"
#include "http/content.h"
#include "service/job_json.h"

namespace drupe {
namespace {

class ModelRoutes {
 public:
  explicit ModelRoutes(const ModelContext& context) : context_(context) {}

  Status Train(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const std::string key, ReadIdempotencyKey(request));
    DRUPE_ASSIGN_OR_RETURN(const ModelRequest asked, ReadModelForm(request, context_.objects, context_.limits));
    DRUPE_ASSIGN_OR_RETURN(const Job job, context_.models.Train(asked, key));
    response.SetJson(ModelJson(job), 202);
    response.SetHeader("Location", LinkOf(job));
    return Status::Ok();
  }

  Status Get(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const Job job, context_.models.Find(request.Capture("id")));
    response.SetJson(ModelJson(job));
    return Status::Ok();
  }

  Status GetDefault(const Request&, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const ColourModel model, DefaultBackgroundModel());
    response.SetJson(ToJson(model));
    return Status::Ok();
  }

  Status GetFile(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const std::string sha256, context_.models.FileOf(request.Capture("id")));
    DRUPE_ASSIGN_OR_RETURN(std::string bytes, context_.models.Read(sha256));
    SendContent(request, MakeByteSource(std::move(bytes)), "application/json", sha256, response);
    return Status::Ok();
  }

  Status List(const Request& request, Response& response) const {
    DRUPE_ASSIGN_OR_RETURN(const std::int64_t limit, request.QueryInt("limit", 50, 1, 200));
    DRUPE_ASSIGN_OR_RETURN(const JobPage page,
                           context_.models.List(static_cast<int>(limit), request.Query("cursor").value_or("")));
    Json models = Json::array();
    for (const Job& job : page.jobs) models.push_back(ModelJson(job));
    const Json next = page.next_cursor.empty() ? Json() : Json(page.next_cursor);
    response.SetJson({{"models", std::move(models)}, {"next_cursor", next}});
    return Status::Ok();
  }

 private:
  std::string LinkOf(const Job& job) const { return context_.public_url + "/models/" + job.id; }

  Json ModelJson(const Job& job) const {
    const Json result = job.result.value_or(Json::object());
    Json links = {{"self", LinkOf(job)}};
    if (job.state == JobState::kSucceeded) links["model"] = LinkOf(job) + "/model.json";
    Json json = JobJson(job);
    json["options"] = job.payload.value("options", Json::object());
    json["clouds"] = job.payload.value("clouds", Json::array()).size();
    json["images"] = job.payload.value("pictures", Json::array()).size();
    json["support_vectors"] = result.value("support_vectors", Json());
    json["confusion"] = result.value("confusion", Json());
    json["links"] = std::move(links);
    return json;
  }

  const ModelContext context_;
};

using Method = Status (ModelRoutes::*)(const Request&, Response&) const;

}  // namespace

void AddModelRoutes(Router& router, const ModelContext& context) {
  const auto routes = std::make_shared<ModelRoutes>(context);
  const auto add = [&](Method method) {
    return [routes, method](const Request& request, Response& response) {
      if (const Status status = ((*routes).*method)(request, response); !status.ok()) response.SetError(status);
    };
  };
  const RouteOptions plain{.max_body_bytes = 0};
  const RouteOptions upload{.max_body_bytes = context.limits.max_request_bytes, .upload = true};
  router.Add("POST", "/models", upload, add(&ModelRoutes::Train));
  router.Add("GET", "/models", plain, add(&ModelRoutes::List));
  router.Add("GET", "/models/default", plain, add(&ModelRoutes::GetDefault));
  router.Add("GET", "/models/{id:mdl}", plain, add(&ModelRoutes::Get));
  router.Add("GET", "/models/{id:mdl}/model.json", plain, add(&ModelRoutes::GetFile));
}

}  // namespace drupe
