#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/limits.h"
#include "base/run_context.h"
#include "base/status.h"
#include "jobs/job_store.h"
#include "reconstruction/derived_cache.h"
#include "reconstruction/image_sets.h"
#include "reconstruction/pipeline.h"
#include "reconstruction/pipeline_options.h"
#include "reconstruction/reconstruct_request.h"
#include "scene/features.h"
#include "store/object_store.h"

namespace drupe {

inline constexpr const char* kPrepareKind = "prepare";
inline constexpr const char* kMatchKind = "match";

/// What the jobs for arriving pictures work on. Stores and cache must outlive the jobs.
struct ArrivalStores {
  ObjectStore& objects;
  ImageSetStore& sets;
  DerivedCache& cache;
  Limits limits;
};

/// The job that is left for every picture which arrives in an image set: finds what the reconstruction will need of it
/// and leaves it in the cache, so that little is left to do after the last picture. A job, so that a crash loses none,
/// a picture on which the program dies is given up after a few attempts, and another machine may do it. Runs at a low
/// priority, since uploads and reconstructions come first. Its result is {"features", "candidates"}: how many there
/// are, and what DescribeArrived tells of the pictures that came before, for whoever looks on (PreparationsOf).
class PrepareJob {
 public:
  explicit PrepareJob(const ArrivalStores& stores) : stores_(stores) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  /// DescribeArrived, among the pictures that the set has now.
  Result<std::vector<std::string>> Compare(const SourceImage& image, const Features& features,
                                           const ReconstructRequest& request, const ReconstructionOptions& options,
                                           const RunContext& context) const;

  const ArrivalStores stores_;
};

/// The second job that is left for every picture, done when no picture waits to be prepared: MatchArrived, with the
/// pictures most like it. Its result is {"pairs"}: how many were matched.
class MatchJob {
 public:
  explicit MatchJob(const ArrivalStores& stores) : stores_(stores) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  const ArrivalStores stores_;
};

/// Leaves both jobs for `image`; `announced` is what will be asked of its set, as far as it is known. Does nothing
/// while many jobs wait: the reconstruction then does the work itself. Errors: those of the job store.
Status LeavePreparation(JobStore& jobs, const ReconstructRequest& announced, const StoredImage& image);

/// For every picture of the set the result of its PrepareJob, as far as it is done and not yet forgotten. Errors: those
/// of the job store.
Result<std::vector<std::optional<Json>>> PreparationsOf(const ImageSet& set, JobStore& jobs);

}  // namespace drupe
