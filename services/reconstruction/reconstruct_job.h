#pragma once

#include <string>
#include <vector>

#include "base/limits.h"
#include "base/run_context.h"
#include "base/status.h"
#include "http/client.h"
#include "jobs/job_runner.h"
#include "jobs/job_store.h"
#include "reconstruction/derived_cache.h"
#include "store/object_store.h"

namespace drupe {

inline constexpr const char* kReconstructKind = "reconstruct";
inline constexpr const char* kAnnounceKind = "announce";

/// The job behind a reconstruction: reads the pictures from the store, reconstructs, stores the artifacts, and leaves a
/// job that tells the analysis service. Its result is {"artifacts": [{"name", "sha256", "bytes", "type"}], "quality",
/// "timings", "refused_images"}.
class ReconstructJob {
 public:
  /// Both stores must outlive the job, and so must `cache`, which may be null.
  ReconstructJob(ObjectStore& objects, JobStore& jobs, DerivedCache* cache, const Limits& limits)
      : objects_(objects), jobs_(jobs), cache_(cache), limits_(limits) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  ObjectStore& objects_;
  JobStore& jobs_;
  DerivedCache* cache_;
  const Limits limits_;
};

/// The stages of ReconstructJob with their shares of the progress bar.
std::vector<StageShare> ReconstructStages();

/// Tells the analysis service that a reconstruction is ready. A job of its own, so that an analysis service that is
/// away for hours, or a kill -9 of this one, loses nothing: it is tried again with growing pauses.
class AnnounceJob {
 public:
  /// `jobs` must outlive the job.
  AnnounceJob(JobStore& jobs, Client analysis) : jobs_(jobs), analysis_(std::move(analysis)) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  JobStore& jobs_;
  Client analysis_;
};

/// Queues announcements again that used up their attempts; for the start of the service.
Status ReviveAnnouncements(JobStore& jobs);

}  // namespace drupe
