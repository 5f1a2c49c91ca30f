#include "reconstruction/prepare_job.h"

#include <sys/resource.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/digest.h"
#include "base/log.h"
#include "reconstruction/arrived_picture.h"
#include "reconstruction/match_arrived.h"
#include "reconstruction/picture_features.h"
#include "reconstruction/pipeline_options.h"
#include "reconstruction/reconstruct_input.h"

namespace drupe {
namespace {

/// So many jobs may wait before pictures are no longer prepared, far from where the queue refuses reconstructions.
constexpr std::int64_t kMaxWaiting = 2'000;
constexpr int kAttempts = 2;
constexpr int kNice = 10;
constexpr int kJobsAPage = 1000;
/// Below the jobs that find features, without which nothing can begin.
constexpr int kMatchPriority = -1;

/// Of the calling thread alone, once: on Linux, 0 means the thread. A refusal costs nothing but politeness.
void LowerThreadPriority() {
  static thread_local const int lowered = setpriority(PRIO_PROCESS, 0, kNice);
  static_cast<void>(lowered);
}

std::string KeyOf(const std::string& kind, const std::string& set, const StoredImage& image) {
  return kind + ":" + set + ":" + Sha256Hex(image.name + "/" + image.sha256);
}

ReconstructionInput InputOf(const ReconstructRequest& request, const ArrivalStores& stores) {
  return MakeInput(request, stores.objects, &stores.cache, stores.limits);
}

/// The request with the pictures that its set has now.
Result<ReconstructRequest> WithPresentImages(ReconstructRequest request, ImageSetStore& sets) {
  DRUPE_ASSIGN_OR_RETURN(ImageSet set, sets.Get(request.image_set));
  request.images = std::move(set.images);
  return request;
}

/// What cannot be done early, because a set was forgotten or another of its pictures cannot be read, is left to the
/// reconstruction, which says why.
template <typename T>
Result<T> DoneOrLeft(Result<T> done) {
  if (done.ok() || done.status().kind() == StatusKind::kCancelled) return done;
  Log(LogLevel::kWarning, "cannot compare a picture yet", {{"error", done.status().ToString()}});
  return T();
}

Status Leave(JobStore& jobs, const char* kind, const char* id_prefix, int priority, const ReconstructRequest& request) {
  JobSpec spec;
  spec.kind = kind;
  spec.id_prefix = id_prefix;
  spec.subject = request.image_set;
  spec.payload = ToPayload(request);
  spec.priority = priority;
  spec.idempotency_key = KeyOf(kind, request.image_set, request.images.front());
  spec.max_attempts = kAttempts;
  return jobs.Submit(spec).status();
}

}  // namespace

Result<Json> PrepareJob::operator()(const Job& job, const RunContext& context) const {
  LowerThreadPriority();
  DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest request, FromPayload(job.payload));
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOptions options, ParseReconstructionOptions(request.options));
  const ReconstructionInput input = InputOf(request, stores_);
  std::size_t features = 0;
  std::vector<std::string> candidates;
  for (const SourceImage& image : input.images) {
    DRUPE_ASSIGN_OR_RETURN(const PictureFeatures found, FindPictureFeatures(image, input, options, context));
    features += found.features.size();
    DRUPE_ASSIGN_OR_RETURN(candidates, DoneOrLeft(Compare(image, found.features, request, options, context)));
  }
  return Json{{"features", features}, {"candidates", candidates}};
}

Result<std::vector<std::string>> PrepareJob::Compare(const SourceImage& image, const Features& features,
                                                     const ReconstructRequest& request,
                                                     const ReconstructionOptions& options,
                                                     const RunContext& context) const {
  DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest present, WithPresentImages(request, stores_.sets));
  return DescribeArrived(image, features, InputOf(present, stores_), options, context);
}

Result<Json> MatchJob::operator()(const Job& job, const RunContext& context) const {
  LowerThreadPriority();
  DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest request, FromPayload(job.payload));
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOptions options, ParseReconstructionOptions(request.options));
  const ReconstructionInput arrived = InputOf(request, stores_);
  const auto match = [&](const SourceImage& image) -> Result<int> {
    DRUPE_ASSIGN_OR_RETURN(const ReconstructRequest present, WithPresentImages(request, stores_.sets));
    const ReconstructionInput set = InputOf(present, stores_);
    if (!IsTimeToMatch(image, set)) return 0;
    DRUPE_ASSIGN_OR_RETURN(const Features features, FindFeatures(image, set, options, context));
    DRUPE_ASSIGN_OR_RETURN(const std::vector<std::string> alike,
                           DescribeArrived(image, features, set, options, context));
    return MatchArrived(image, alike, set, options, context);
  };
  int pairs = 0;
  for (const SourceImage& image : arrived.images) {
    DRUPE_ASSIGN_OR_RETURN(const int matched, DoneOrLeft(match(image)));
    pairs += matched;
  }
  return Json{{"pairs", pairs}};
}

Status LeavePreparation(JobStore& jobs, const ReconstructRequest& announced, const StoredImage& image) {
  DRUPE_ASSIGN_OR_RETURN(const JobCounts counts, jobs.Counts());
  if (counts.queued >= kMaxWaiting) return Status::Ok();
  ReconstructRequest request = announced;
  request.images = {image};
  DRUPE_RETURN_IF_ERROR(Leave(jobs, kPrepareKind, "prep", 0, request));
  return Leave(jobs, kMatchKind, "match", kMatchPriority, request);
}

Result<std::vector<std::optional<Json>>> PreparationsOf(const ImageSet& set, JobStore& jobs) {
  const JobFilter done{.kind = kPrepareKind, .subject = set.id, .state = JobState::kSucceeded};
  std::map<std::string, Json> results;
  std::string cursor;
  do {
    DRUPE_ASSIGN_OR_RETURN(JobPage page, jobs.List(done, kJobsAPage, cursor));
    for (Job& job : page.jobs) {
      if (job.result) results[job.idempotency_key] = *std::move(job.result);
    }
    cursor = page.next_cursor;
  } while (!cursor.empty());
  std::vector<std::optional<Json>> preparations;
  for (const StoredImage& image : set.images) {
    const auto found = results.find(KeyOf(kPrepareKind, set.id, image));
    preparations.push_back(found == results.end() ? std::nullopt : std::optional(found->second));
  }
  return preparations;
}

}  // namespace drupe
