#include "reconstruction/reconstruct_request.h"

#include "base/ids.h"
#include "reconstruction/pipeline_options.h"

namespace drupe {

namespace {

Result<std::optional<Board>> ReadBoard(const Json& json) {
  if (json.is_null()) return std::optional<Board>();
  if (json.is_string() && json.get<std::string>() == "default") return std::optional<Board>(MakeGridBoard());
  DRUPE_ASSIGN_OR_RETURN(Board board, ParseBoard(json));
  return std::optional<Board>(std::move(board));
}

/// Takes `key` out of the options; null when it is not there.
Json TakeKey(Json& options, const char* key) {
  if (!options.is_object() || !options.contains(key)) return nullptr;
  Json value = options.at(key);
  options.erase(key);
  return value;
}

Status ReadAnalyze(const Json& value, bool& analyze) {
  if (value.is_null()) return Status::Ok();
  if (!value.is_boolean()) return InvalidArgument("invalid_option", "analyze must be true or false", "analyze");
  analyze = value.get<bool>();
  return Status::Ok();
}

Status ReadWebhook(const Json& value, std::string& webhook) {
  if (value.is_null()) return Status::Ok();
  if (!value.is_string()) return InvalidArgument("invalid_option", "webhook must be a URL", "webhook");
  webhook = value.get<std::string>();
  return Status::Ok();
}

Status ReadOptions(Json options, ReconstructRequest& request) {
  DRUPE_RETURN_IF_ERROR(ReadAnalyze(TakeKey(options, "analyze"), request.analyze));
  const Json analysis = TakeKey(options, "analysis");
  if (!analysis.is_null() && !analysis.is_object()) {
    return InvalidArgument("invalid_option", "analysis must be an object", "analysis");
  }
  if (analysis.is_object()) request.analysis_options = analysis;
  DRUPE_RETURN_IF_ERROR(ReadWebhook(TakeKey(options, "webhook"), request.webhook));
  const Result<ReconstructionOptions> parsed = ParseReconstructionOptions(options);
  if (!parsed.ok()) return parsed.status();
  if (options.is_object()) request.options = std::move(options);
  return Status::Ok();
}

Status CheckSize(const ReconstructRequest& request) {
  if (!request.calibration || request.images.empty()) return Status::Ok();
  return CheckCalibrationSize(*request.calibration, request.images.front().width, request.images.front().height);
}

Status CheckJsonKeys(const Json& body) {
  if (!body.is_object() || !body.contains("image_set") || !body.at("image_set").is_string()) {
    return InvalidArgument("invalid_request", "the body must be an object with the id of an image_set", "image_set");
  }
  for (const auto& [key, value] : body.items()) {
    if (key != "image_set" && key != "calibration" && key != "board" && key != "options" && key != "analyze") {
      return InvalidArgument("unknown_option", "there is no \"" + key + "\" in this request", key);
    }
  }
  return Status::Ok();
}

Json ValueOrNull(const Json& object, const char* key) {
  return object.contains(key) ? object.at(key) : Json();
}

/// The documents of `request`, and where it has none those of `announced`.
RequestDocuments DocumentsOf(const Json& request, const Json& announced) {
  const auto pick = [&](const char* key) { return ValueOrNull(request.contains(key) ? request : announced, key); };
  return {pick("calibration"), pick("board"), pick("options")};
}

}  // namespace

Status ApplyDocuments(const RequestDocuments& documents, ReconstructRequest& request) {
  if (!documents.calibration.is_null()) {
    DRUPE_ASSIGN_OR_RETURN(request.calibration, ParseCalibration(documents.calibration));
  }
  DRUPE_ASSIGN_OR_RETURN(request.board, ReadBoard(documents.board));
  DRUPE_RETURN_IF_ERROR(ReadOptions(documents.options, request));
  return CheckSize(request);
}

Result<ReconstructRequest> ReadReconstructJson(const Request& http, ImageSetStore& sets, const Limits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const Json body, ReadJsonBody(http));
  DRUPE_RETURN_IF_ERROR(CheckJsonKeys(body));
  ReconstructRequest request;
  request.image_set = body.at("image_set").get<std::string>();
  if (!IsId(request.image_set, "set")) {
    return InvalidArgument("invalid_id", "image_set is not the id of an image set", "image_set");
  }
  DRUPE_ASSIGN_OR_RETURN(const ImageSet set, sets.Get(request.image_set));
  if (static_cast<int>(set.images.size()) < limits.min_images) {
    return InvalidArgument("too_few_images",
                           "at least " + std::to_string(limits.min_images) + " images are needed, the set has " +
                               std::to_string(set.images.size()),
                           "image_set");
  }
  request.images = set.images;
  DRUPE_RETURN_IF_ERROR(ApplyDocuments(DocumentsOf(body, set.announced), request));
  DRUPE_RETURN_IF_ERROR(ReadAnalyze(ValueOrNull(body, "analyze"), request.analyze));
  return request;
}

Result<Json> ReadAnnouncement(const Request& http) {
  if (http.body->length() == 0) return Json::object();
  DRUPE_ASSIGN_OR_RETURN(Json body, ReadJsonBody(http));
  if (!body.is_object()) return InvalidArgument("invalid_request", "the body must be empty or an object");
  for (const auto& [key, value] : body.items()) {
    if (key != "calibration" && key != "board" && key != "options") {
      return InvalidArgument("unknown_option", "an image set announces no \"" + key + "\"", key);
    }
  }
  ReconstructRequest checked;
  DRUPE_RETURN_IF_ERROR(ApplyDocuments(DocumentsOf(body, {}), checked));
  return body;
}

Result<ReconstructRequest> AnnouncedRequest(const ImageSet& set) {
  ReconstructRequest request;
  request.image_set = set.id;
  DRUPE_RETURN_IF_ERROR(ApplyDocuments(DocumentsOf(set.announced, {}), request));
  return request;
}

Json ToPayload(const ReconstructRequest& request) {
  Json payload = {{"image_set", request.image_set},
                  {"images", ToJson(request.images)},
                  {"refused_images", request.refused_images},
                  {"calibration", request.calibration ? ToJson(*request.calibration) : Json()},
                  {"board", request.board ? ToJson(*request.board) : Json()},
                  {"options", request.options},
                  {"analyze", request.analyze},
                  {"analysis_options", request.analysis_options}};
  if (!request.webhook.empty()) payload["webhook"] = request.webhook;
  return payload;
}

Result<ReconstructRequest> FromPayload(const Json& payload) {
  ReconstructRequest request;
  try {
    request.image_set = payload.at("image_set");
    DRUPE_ASSIGN_OR_RETURN(request.images, ParseStoredImages(payload.at("images")));
    request.refused_images = payload.at("refused_images");
    DRUPE_RETURN_IF_ERROR(
        ApplyDocuments({payload.at("calibration"), payload.at("board"), payload.at("options")}, request));
    request.analyze = payload.at("analyze");
    request.analysis_options = payload.at("analysis_options");
    request.webhook = payload.value("webhook", "");
  } catch (const Json::exception& error) {
    return Internal("bad_payload", std::string("a stored request is malformed: ") + error.what());
  }
  return request;
}

}  // namespace drupe
