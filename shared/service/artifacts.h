#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "http/request.h"
#include "http/response.h"
#include "jobs/job.h"
#include "store/object_store.h"

namespace drupe {

/// A file that a job has left, kept as an object.
struct Artifact {
  std::string name = "";
  std::string sha256 = "";  ///< of the object
  std::uint64_t bytes = 0;

  bool operator==(const Artifact&) const = default;
};

/// Stores files given by name; the list is ascending by name. Errors: those of ObjectStore::Put.
Result<std::vector<Artifact>> StoreArtifacts(const std::map<std::string, std::string>& files, ObjectStore& objects);

/// [{"name", "sha256", "bytes", "type"}]: how artifacts are listed and how jobs keep them. `type` is the Content-Type
/// that SendArtifact gives; it follows from the name.
Json ToJson(const std::vector<Artifact>& artifacts);
/// Reads what ToJson wrote, with or without `type`; anything else gives no artifacts.
std::vector<Artifact> ParseArtifacts(const Json& json);

/// Answers with the artifact of `job` that the route's {name} asks for, with ETag and Range (SendContent). Errors: 404
/// `artifact_not_found`; those of ObjectStore::OpenObject.
Status SendArtifact(const Request& request, const Job& job, const std::vector<Artifact>& artifacts,
                    ObjectStore& objects, Response& response);

}  // namespace drupe
