#pragma once

#include <string>
#include <string_view>

#include "base/status.h"
#include "defect_analysis/model_request.h"
#include "jobs/job_store.h"
#include "store/object_store.h"

namespace drupe {

/// The background models that were asked for: each is a job, and once that has succeeded a file in the object store.
/// Thread-safe.
class ModelCatalogue {
 public:
  /// Both must outlive the catalogue.
  ModelCatalogue(JobStore& jobs, ObjectStore& objects) : jobs_(jobs), objects_(objects) {}

  /// Queues the training of a model. Errors: those of JobStore::Submit.
  Result<Job> Train(const ModelRequest& request, const std::string& idempotency_key);
  /// Errors: 404 `model_not_found`.
  Result<Job> Find(std::string_view id);
  Result<JobPage> List(int limit, const std::string& cursor);
  /// SHA-256 of a trained model's file. Errors: 404 `model_not_found`, 409 `model_not_ready`.
  Result<std::string> FileOf(std::string_view id);
  /// A model's file, digest checked.
  Result<std::string> Read(const std::string& sha256) { return objects_.Get(sha256); }

 private:
  JobStore& jobs_;
  ObjectStore& objects_;
};

}  // namespace drupe
