#include "defect_analysis/reconstruction_client.h"

#include <map>
#include <utility>

#include "base/digest.h"
#include "scene/cameras_json.h"
#include "scene/ply.h"

namespace drupe {

namespace {

constexpr std::uint64_t kMaxArtifactBytes = std::uint64_t{2} << 30;
constexpr JsonLimits kCamerasLimits{.max_bytes = std::size_t{64} << 20, .max_depth = 32};

Status BadReply(std::string_view what) {
  return Internal("bad_reply", "the reconstruction service's reply has no valid " + std::string(what));
}

/// The value under `key` when it has the wanted type, else nullptr. Replies are read as carefully as requests.
const Json* Find(const Json& object, const char* key, Json::value_t type) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found != object.end() && found->type() == type ? &*found : nullptr;
}

std::string TextOf(const Json& object, const char* key) {
  const Json* text = Find(object, key, Json::value_t::string);
  return text != nullptr ? text->get<std::string>() : "";
}

Json ObjectOf(const Json& object, const char* key) {
  const Json* value = Find(object, key, Json::value_t::object);
  return value != nullptr ? *value : Json::object();
}

Status CheckFinished(const Json& status) {
  const std::string state = TextOf(status, "status");
  if (state == "succeeded") return Status::Ok();
  if (state == "queued" || state == "running") {
    return {StatusKind::kUnavailable, "reconstruction_not_finished", "the reconstruction is still " + state};
  }
  if (state == "failed" || state == "cancelled") {
    return Unprocessable("reconstruction_failed", "there is nothing to analyse: the reconstruction has " +
                                                      std::string(state == "failed" ? "failed" : "been cancelled"));
  }
  return BadReply("status");
}

/// The digests of the artifacts by name.
Result<std::map<std::string, std::string>> ReadArtifacts(const Json& status) {
  const Json* listed = Find(status, "artifacts", Json::value_t::array);
  if (listed == nullptr) return BadReply("artifacts");
  std::map<std::string, std::string> digests;
  for (const Json& artifact : *listed) {
    const std::string sha256 = TextOf(artifact, "sha256");
    if (!IsSha256Hex(sha256)) return BadReply("artifacts");
    digests[TextOf(artifact, "name")] = sha256;
  }
  if (!digests.contains("cameras.json")) return BadReply("cameras.json among its artifacts");
  if (!digests.contains("dense.ply")) {
    return Unprocessable("no_dense_cloud", "the reconstruction was made without a dense cloud");
  }
  return digests;
}

Provenance ReadProvenance(const Json& status) {
  const Json json = ObjectOf(status, "provenance");
  Provenance provenance;
  provenance.image_set = TextOf(json, "image_set");
  if (provenance.image_set.empty()) provenance.image_set = TextOf(status, "image_set");
  if (const Json* digests = Find(json, "image_sha256", Json::value_t::array)) {
    for (const Json& digest : *digests) {
      provenance.image_sha256.push_back(digest.is_string() ? digest.get<std::string>() : "");
    }
  }
  provenance.calibration = json.contains("calibration") ? json["calibration"] : Json(nullptr);
  provenance.options = ObjectOf(json, "options");
  provenance.build = TextOf(json, "build");
  return provenance;
}

/// {"stages": [{"name", "wall_s", ...}]} as {NAME: wall_s}.
Json StageSeconds(const Json& timings) {
  Json seconds = Json::object();
  const Json* stages = Find(timings, "stages", Json::value_t::array);
  if (stages == nullptr) return seconds;
  for (const Json& stage : *stages) {
    const std::string name = TextOf(stage, "name");
    if (!name.empty() && stage.contains("wall_s") && stage["wall_s"].is_number()) seconds[name] = stage["wall_s"];
  }
  return seconds;
}

Status ReadCameras(std::string_view text, FetchedReconstruction& fetched) {
  DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(text, kCamerasLimits));
  DRUPE_ASSIGN_OR_RETURN(fetched.model, ParseCameras(json));
  fetched.input.scale_source = fetched.model.scale_source;
  fetched.input.scale_relative_sigma = fetched.model.scale_relative_sigma;
  for (const View& view : fetched.model.views) {
    if (view.cam_from_world) fetched.input.camera_centres.push_back(view.cam_from_world->Centre());
  }
  return Status::Ok();
}

/// By name, since the views are not all pictures of the set: damaged ones are left out.
std::vector<std::string> PhotographsOf(const Json& provenance, const SparseModel& model) {
  std::map<std::string, std::string> digests;
  const Json* names = Find(provenance, "image_names", Json::value_t::array);
  const Json* listed = Find(provenance, "image_sha256", Json::value_t::array);
  if (names != nullptr && listed != nullptr && names->size() == listed->size()) {
    for (std::size_t k = 0; k < names->size(); ++k) {
      if ((*names)[k].is_string() && (*listed)[k].is_string()) digests[(*names)[k]] = (*listed)[k];
    }
  }
  std::vector<std::string> photographs;
  for (const View& view : model.views) photographs.push_back(digests[view.image]);
  return photographs;
}

}  // namespace

Result<ReconstructionClient> ReconstructionClient::Create(const std::string& base_url, ObjectStore& objects) {
  DRUPE_ASSIGN_OR_RETURN(Client client, Client::Create(base_url));
  return ReconstructionClient(std::move(client), objects);
}

Result<FetchedReconstruction> ReconstructionClient::Fetch(const std::string& id, const RunContext& context) const {
  DRUPE_ASSIGN_OR_RETURN(const Client::Reply reply, client_.Get("/reconstructions/" + id));
  DRUPE_RETURN_IF_ERROR(CheckFinished(reply.json));
  DRUPE_ASSIGN_OR_RETURN(const auto digests, ReadArtifacts(reply.json));
  const auto fetch = [&](const std::string& name) { return FetchArtifact(id, name, digests.at(name), context); };
  FetchedReconstruction fetched;
  DRUPE_ASSIGN_OR_RETURN(const std::string cameras, fetch("cameras.json"));
  DRUPE_RETURN_IF_ERROR(ReadCameras(cameras, fetched));
  DRUPE_ASSIGN_OR_RETURN(const std::string cloud, fetch("dense.ply"));
  DRUPE_ASSIGN_OR_RETURN(fetched.input.cloud, ReadPly(cloud));
  if (digests.contains("board.json")) {
    DRUPE_ASSIGN_OR_RETURN(const std::string board, fetch("board.json"));
    DRUPE_ASSIGN_OR_RETURN(const Json json, ParseJson(board));
    DRUPE_ASSIGN_OR_RETURN(fetched.input.board, ParseBoard(json));
  }
  fetched.quality = ObjectOf(reply.json, "quality");
  fetched.timings_s = StageSeconds(ObjectOf(reply.json, "timings"));
  fetched.provenance = ReadProvenance(reply.json);
  fetched.photographs = PhotographsOf(ObjectOf(reply.json, "provenance"), fetched.model);
  return fetched;
}

Result<std::string> ReconstructionClient::FetchArtifact(const std::string& id, const std::string& name,
                                                        const std::string& sha256, const RunContext& context) const {
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  if (objects_->Contains(sha256)) {
    Result<std::string> stored = objects_->Get(sha256, kMaxArtifactBytes);
    if (stored.ok()) return stored;  // otherwise it is damaged, or was removed meanwhile
  }
  DRUPE_ASSIGN_OR_RETURN(std::string content, Download("/reconstructions/" + id + "/artifacts/" + name, context));
  if (Sha256Hex(content) == sha256) return content;
  return Status(StatusKind::kDataLoss, "artifact_damaged", name + " arrived with another digest");
}

Result<std::string> ReconstructionClient::Download(const std::string& path, const RunContext& context) const {
  std::string content;
  const Status status = client_.Download(path, kMaxArtifactBytes, [&](std::string_view piece) {
    content.append(piece);
    return !context.IsCancelled();
  });
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  DRUPE_RETURN_IF_ERROR(status);
  return content;
}

}  // namespace drupe
