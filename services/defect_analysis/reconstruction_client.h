#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "base/run_context.h"
#include "base/status.h"
#include "defect_analysis/pipeline.h"
#include "http/client.h"
#include "scene/report.h"
#include "scene/sparse_model.h"
#include "store/object_store.h"

namespace drupe {

/// A finished reconstruction as the analysis needs it.
struct FetchedReconstruction {
  AnalysisInput input;
  SparseModel model;  ///< cameras and poses, without tracks
  /// SHA-256 of the photograph of each view of `model`; "" where the service does not tell.
  std::vector<std::string> photographs;
  Json quality = Json::object();
  Json timings_s = Json::object();  ///< stage name to wall seconds
  Provenance provenance;            ///< `options` holds those of the reconstruction
};

/// Gets reconstructions from the service that made them. Artifacts come from the object store when it has them (the
/// services of one machine may share a data directory), otherwise over HTTP, and their digest is checked either way.
/// Thread-safe.
class ReconstructionClient {
 public:
  /// `objects` must outlive the client. Errors: 400 `invalid_url`.
  static Result<ReconstructionClient> Create(const std::string& base_url, ObjectStore& objects);

  /// Errors: 503 `unreachable`, `reconstruction_not_finished`; 422 `reconstruction_failed`, `no_dense_cloud`; those of
  /// the service (404 for an unknown id); 500 `bad_reply`; 500 `artifact_damaged` (kDataLoss); `cancelled`.
  Result<FetchedReconstruction> Fetch(const std::string& id, const RunContext& context) const;

 private:
  ReconstructionClient(Client client, ObjectStore& objects) : client_(std::move(client)), objects_(&objects) {}

  Result<std::string> FetchArtifact(const std::string& id, const std::string& name, const std::string& sha256,
                                    const RunContext& context) const;
  Result<std::string> Download(const std::string& path, const RunContext& context) const;

  Client client_;
  ObjectStore* objects_;
};

}  // namespace drupe
