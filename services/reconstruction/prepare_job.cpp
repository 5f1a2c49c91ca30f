#include "reconstruction/prepare_job.h"

#include <sys/resource.h>

#include "base/digest.h"
#include "reconstruction/picture_features.h"
#include "reconstruction/pipeline_options.h"
#include "reconstruction/reconstruct_input.h"

namespace drupe {
namespace {

/// So many jobs may wait before pictures are no longer prepared, far from where the queue refuses reconstructions.
constexpr std::int64_t kMaxWaiting = 2'000;
constexpr int kAttempts = 2;
constexpr int kNice = 10;

/// Of the calling thread alone, once: on Linux, 0 means the thread. A refusal costs nothing but politeness.
void LowerThreadPriority() {
  static thread_local const int lowered = setpriority(PRIO_PROCESS, 0, kNice);
  static_cast<void>(lowered);
}

}  // namespace

Result<Json> PrepareJob::operator()(const Job& job, const RunContext& context) const {
  LowerThreadPriority();
  DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest request, FromPayload(job.payload));
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOptions options, ParseReconstructionOptions(request.options));
  const ReconstructionInput input = MakeInput(request, objects_, &cache_, limits_);
  std::size_t features = 0;
  for (const SourceImage& image : input.images) {
    DRUPE_ASSIGN_OR_RETURN(const PictureFeatures found, FindPictureFeatures(image, input, options, context));
    features += found.features.size();
  }
  return Json{{"features", features}};
}

Status LeavePreparation(JobStore& jobs, const ReconstructRequest& announced, const StoredImage& image) {
  DRUPE_ASSIGN_OR_RETURN(const JobCounts counts, jobs.Counts());
  if (counts.queued >= kMaxWaiting) return Status::Ok();
  ReconstructRequest request = announced;
  request.images = {image};
  JobSpec spec;
  spec.kind = kPrepareKind;
  spec.id_prefix = "prep";
  spec.subject = announced.image_set;
  spec.payload = ToPayload(request);
  spec.idempotency_key = "prepare:" + announced.image_set + ":" + Sha256Hex(image.name + "/" + image.sha256);
  spec.max_attempts = kAttempts;
  return jobs.Submit(spec).status();
}

}  // namespace drupe
