#include "base/log.h"
#include "http/request.h"
#include "http/response.h"
#include "reconstruction/intake.h"
#include "reconstruction/prepare_job.h"
#include "reconstruction/reconstruct_request.h"
#include "reconstruction/routes.h"

namespace drupe {

namespace {

Json SetJson(const ImageSet& set, const LinkBase& links) {
  const std::string self = links.self + "/image-sets/" + set.id;
  return {{"id", set.id},
          {"created_at", FormatUtc(set.created_ms)},
          {"images", ToJson(set.images)},
          {"links", {{"self", self}, {"images", self + "/images"}}}};
}

void CreateSet(const RouteContext& context, const Request& request, Response& response) {
  const Result<Json> announced = ReadAnnouncement(request);
  if (!announced.ok()) return response.SetError(announced.status());
  const Result<ImageSet> set = context.sets.Create(*announced);
  if (!set.ok()) return response.SetError(set.status());
  response.SetJson(SetJson(*set, context.links), 201);
  response.SetHeader("Location", context.links.self + "/image-sets/" + set->id);
}

/// With what is known of the pictures already.
Result<Json> PreparedSetJson(const RouteContext& context, const std::string& id) {
  DRUPE_ASSIGN_OR_RETURN(const ImageSet set, context.sets.Get(id));
  DRUPE_ASSIGN_OR_RETURN(const auto preparations, PreparationsOf(set, context.jobs));
  Json json = SetJson(set, context.links);
  for (std::size_t i = 0; i < preparations.size(); ++i) {
    if (preparations[i]) json["images"][i]["prepared"] = *preparations[i];
  }
  return json;
}

void GetSet(const RouteContext& context, const Request& request, Response& response) {
  const Result<Json> json = PreparedSetJson(context, request.Capture("id"));
  if (!json.ok()) return response.SetError(json.status());
  response.SetJson(*json);
}

struct PutResult {
  StoredImage image;
  PutOutcome outcome;
};

/// The picture is stored whatever comes of this: what is not prepared is done by the reconstruction.
void Prepare(const RouteContext& context, const ImageSet& set, const StoredImage& image) {
  const Result<ReconstructRequest> announced = AnnouncedRequest(set);
  const Status left = announced.ok() ? LeavePreparation(context.jobs, *announced, image) : announced.status();
  if (!left.ok()) Log(LogLevel::kWarning, "cannot prepare a picture", {{"set", set.id}, {"error", left.ToString()}});
}

Result<PutResult> StoreInSet(const RouteContext& context, const Request& request) {
  const std::string& id = request.Capture("id");
  const Result<ImageSet> set = context.sets.Get(id);  // before the body is read for nothing
  if (!set.ok()) return set.status();
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadBody(request, context.limits.max_image_bytes));
  DRUPE_ASSIGN_OR_RETURN(const StoredImage image,
                         StoreImage(context.objects, request.Capture("name"), bytes, context.limits));
  DRUPE_ASSIGN_OR_RETURN(const PutOutcome outcome, context.sets.PutImage(id, image));
  if (context.prepare && outcome != PutOutcome::kUnchanged) Prepare(context, *set, image);
  return PutResult{image, outcome};
}

void PutImage(const RouteContext& context, const Request& request, Response& response) {
  const Result<PutResult> put = StoreInSet(context, request);
  if (!put.ok()) return response.SetError(put.status());
  response.SetJson(ToJson(std::vector{put->image}).front(), put->outcome == PutOutcome::kAdded ? 201 : 200);
}

}  // namespace

void AddImageSetRoutes(Router& router, const RouteContext& context) {
  const auto bind = [context](auto function) {
    return [context, function](const Request& request, Response& response) { function(context, request, response); };
  };
  const RouteOptions upload{.max_body_bytes = context.limits.max_image_bytes, .upload = true};
  router.Add("POST", "/image-sets", {}, bind(CreateSet));
  router.Add("GET", "/image-sets/{id:set}", {}, bind(GetSet));
  router.Add("PUT", "/image-sets/{id:set}/images/{name}", upload, bind(PutImage));
}

}  // namespace drupe
