#pragma once

#include <string_view>
#include <vector>

#include "base/limits.h"
#include "base/run_context.h"
#include "base/status.h"
#include "jobs/job.h"
#include "jobs/job_runner.h"
#include "store/object_store.h"

namespace drupe {

/// The kind of the jobs that train background models: payload ToJson(ModelRequest), result {"model_sha256",
/// "support_vectors", "confusion": {"training", "test"}}.
inline constexpr std::string_view kTrainKind = "train";

/// The stages of a training job and their usual shares of its time.
std::vector<StageShare> TrainStages();

/// Trains one background model and stores its file.
class TrainJob {
 public:
  /// `objects` must outlive the job.
  TrainJob(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  ObjectStore& objects_;
  const Limits limits_;
};

}  // namespace drupe
