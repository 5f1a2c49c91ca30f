#pragma once

#include <string>
#include <vector>

#include "base/limits.h"
#include "base/run_context.h"
#include "base/stage_parts.h"
#include "base/status.h"
#include "jobs/job_store.h"
#include "store/object_store.h"

namespace drupe {

inline constexpr const char* kPartKind = "part";

/// Does one part of a reconstruction that another worker has at hand. Its payload is that of the reconstruction as
/// "reconstruct", the "stage", and the part's digest as "part"; its result {"sha256"} names the object with what came
/// out.
class PartJob {
 public:
  /// The store must outlive the job.
  PartJob(ObjectStore& objects, const Limits& limits) : objects_(objects), limits_(limits) {}

  Result<Json> operator()(const Job& job, const RunContext& context) const;

 private:
  ObjectStore& objects_;
  const Limits limits_;
};

/// Offers the parts of a running job as jobs of their own, and does itself what nobody has taken: from the last one on,
/// while others take them from the first one on. So nothing waits for a worker that may never come, and a worker that
/// dies, or says it cannot, costs its part's time alone. What an earlier attempt of the job got done is found again.
class PartJobs {
 public:
  /// All must outlive this.
  PartJobs(JobStore& jobs, ObjectStore& objects, const Job& job, const RunContext& context)
      : jobs_(jobs), objects_(objects), job_(job), context_(context) {}

  /// Errors: `cancelled`, those of parts.here and of both stores.
  Result<std::vector<std::string>> Run(const StageParts& parts);

 private:
  struct Offer {
    std::string id;  ///< of its job; empty when it could not be offered
    std::string result;
    bool done = false;
  };

  Status OfferAll(const StageParts& parts, std::vector<Offer>& offers);
  Status Finish(const StageParts& parts, std::vector<Offer>& offers);
  Status Take(const StageParts& parts, std::size_t part, bool wait, Offer& offer);
  Status DoHere(const StageParts& parts, std::size_t part, Offer& offer);
  void Withdraw(const std::vector<Offer>& offers);

  JobStore& jobs_;
  ObjectStore& objects_;
  const Job& job_;
  const RunContext& context_;
};

}  // namespace drupe
