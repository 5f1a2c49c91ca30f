#include "defect_analysis/model_catalogue.h"

#include "defect_analysis/train_job.h"

namespace drupe {

Result<Job> ModelCatalogue::Train(const ModelRequest& request, const std::string& idempotency_key) {
  JobSpec spec;
  spec.kind = kTrainKind;
  spec.id_prefix = "mdl";
  spec.payload = ToJson(request);
  spec.idempotency_key = idempotency_key;
  return jobs_.Submit(spec);
}

Result<Job> ModelCatalogue::Find(std::string_view id) {
  Result<Job> job = jobs_.Get(id);
  const bool unknown = job.ok() ? job->kind != kTrainKind : job.status().kind() == StatusKind::kNotFound;
  if (unknown) return NotFound("model_not_found", "there is no model " + std::string(id));
  return job;
}

Result<JobPage> ModelCatalogue::List(int limit, const std::string& cursor) {
  JobFilter filter;
  filter.kind = kTrainKind;
  return jobs_.List(filter, limit, cursor);
}

Result<std::string> ModelCatalogue::FileOf(std::string_view id) {
  DRUPE_ASSIGN_OR_RETURN(const Job job, Find(id));
  if (job.state == JobState::kSucceeded && job.result) return job.result->value("model_sha256", std::string());
  return Status(StatusKind::kConflict, "model_not_ready",
                "the model " + std::string(id) + " cannot be used: its state is " + JobStateName(job.state));
}

}  // namespace drupe
