#include "service/artifacts.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "http/content.h"
#include "service/object_source.h"

namespace drupe {

namespace {

const char* MediaTypeOf(const std::string& name) {
  if (name.ends_with(".json")) return "application/json";
  if (name.ends_with(".zip")) return "application/zip";
  if (name.ends_with(".png")) return "image/png";
  if (name.ends_with(".csv")) return "text/csv; charset=utf-8";
  return "application/octet-stream";
}

}  // namespace

Result<std::vector<Artifact>> StoreArtifacts(const std::map<std::string, std::string>& files, ObjectStore& objects) {
  std::vector<Artifact> artifacts;
  for (const auto& [name, bytes] : files) {
    DRUPE_ASSIGN_OR_RETURN(const ObjectInfo object, objects.Put(bytes));
    artifacts.push_back({name, object.sha256, object.bytes});
  }
  return artifacts;
}

Json ToJson(const std::vector<Artifact>& artifacts) {
  Json list = Json::array();
  for (const Artifact& artifact : artifacts) {
    list.push_back({{"name", artifact.name},
                    {"sha256", artifact.sha256},
                    {"bytes", artifact.bytes},
                    {"type", MediaTypeOf(artifact.name)}});
  }
  return list;
}

std::vector<Artifact> ParseArtifacts(const Json& json) {
  std::vector<Artifact> artifacts;
  try {
    for (const Json& entry : json) {
      artifacts.push_back({entry.at("name").get<std::string>(), entry.at("sha256").get<std::string>(),
                           entry.at("bytes").get<std::uint64_t>()});
    }
  } catch (const Json::exception&) {
    return {};
  }
  return artifacts;
}

Status SendArtifact(const Request& request, const Job& job, const std::vector<Artifact>& artifacts,
                    ObjectStore& objects, Response& response) {
  const std::string& name = request.Capture("name");
  const auto found = std::ranges::find(artifacts, name, &Artifact::name);
  if (found == artifacts.end()) {
    const std::string why =
        job.state == JobState::kSucceeded ? "" : "; the job is " + std::string(JobStateName(job.state));
    return NotFound("artifact_not_found", "there is no artifact " + name + why);
  }
  DRUPE_ASSIGN_OR_RETURN(std::unique_ptr<ObjectReader> reader, objects.OpenObject(found->sha256));
  SendContent(request, std::make_shared<ObjectSource>(std::move(reader)), MediaTypeOf(name), found->sha256, response);
  return Status::Ok();
}

}  // namespace drupe
