#include "reconstruction/sparse/cluster_models.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "reconstruction/sparse/cluster_part.h"
#include "reconstruction/sparse/incremental.h"
#include "reconstruction/sparse/placement.h"

namespace drupe {
namespace {

bool Contains(const std::vector<int>& cluster, int view) {
  return std::binary_search(cluster.begin(), cluster.end(), view);
}

void AddTrack(const SfmState& whole, std::size_t t, const std::vector<std::uint8_t>& is_in, ClusterModel& model) {
  const auto observations = whole.ObservationsOf(whole.tracks[t]);
  const auto seen = std::count_if(observations.begin(), observations.end(),
                                  [&](const SfmObservation& observation) { return is_in[observation.view] != 0; });
  if (seen < 2) return;
  SfmTrack track;
  track.begin = model.state.observations.size();
  for (SfmObservation observation : observations) {
    if (!is_in[observation.view]) continue;
    observation.track = static_cast<std::int32_t>(model.state.tracks.size());
    model.state.view_observations[observation.view].push_back(model.state.observations.size());
    model.state.observations.push_back(observation);
  }
  track.end = model.state.observations.size();
  model.state.tracks.push_back(track);
  model.whole_track.push_back(static_cast<int>(t));
}

/// The verified pairs of two views of the cluster.
MatchGraph PairsInside(const MatchGraph& matches, const std::vector<int>& cluster) {
  MatchGraph inside;
  for (const TwoViewMatches& pair : matches.pairs) {
    if (Contains(cluster, pair.pair.first) && Contains(cluster, pair.pair.second)) inside.pairs.push_back(pair);
  }
  return inside;
}

ClusterWork WorkOf(const SfmState& whole, const std::vector<int>& cluster, const MatchGraph& matches,
                   const std::vector<std::optional<Rigid3>>& board_poses, const RunContext& context) {
  ClusterWork work{{}, cluster, PairsInside(matches, cluster), {}, context.seed};
  work.board_poses.resize(whole.poses.size());
  for (const int view : cluster) work.board_poses[view] = board_poses[view];
  return work;
}

Status Build(const ClusterWork& work, const SparseOptions& options, const RunContext& context, SfmState& state) {
  const Status placed =
      PlaceViews(work.matches, work.board_poses, static_cast<int>(work.cluster.size()), options, context, state);
  if (placed.code() == "no_initial_pair") return Status::Ok();  // the whole model may place its views later
  DRUPE_RETURN_IF_ERROR(placed);
  return SettleModel(options, context, state);
}

/// Gives every model its views' poses and its tracks' positions, from parts that other machines may have done.
Status BuildInParts(std::vector<ClusterWork>& work, const SparseOptions& options, const RunParts& run_parts,
                    const RunContext& context, std::vector<ClusterModel>& models) {
  StageParts parts;
  parts.stage = "sparse";
  for (std::size_t c = 0; c < work.size(); ++c) {
    work[c].state = models[c].state;
    parts.parts.push_back(WriteClusterWork(work[c]));
  }
  RunContext silent = context;  // the stage's progress is that of all its clusters
  silent.progress = nullptr;
  parts.here = [&](std::size_t c) -> Result<std::string> {
    SfmState state = work[c].state;
    DRUPE_RETURN_IF_ERROR(Build(work[c], options, silent, state));
    return WriteSfmState(state);
  };
  parts.done = [](std::size_t) {};
  DRUPE_ASSIGN_OR_RETURN(const std::vector<std::string> results, run_parts(parts));
  for (std::size_t c = 0; c < work.size(); ++c) {
    DRUPE_ASSIGN_OR_RETURN(models[c].state, ReadSfmState(results[c], work[c].state));
  }
  return Status::Ok();
}

}  // namespace

ClusterModel RestrictTo(const SfmState& whole, const std::vector<int>& cluster) {
  ClusterModel model;
  model.state.camera = whole.camera;
  model.state.view_observations.resize(whole.ViewCount());
  model.state.board_corners.resize(whole.ViewCount());
  model.state.poses.resize(whole.ViewCount());
  model.state.reasons.resize(whole.ViewCount());
  std::vector<std::uint8_t> is_in(whole.ViewCount(), 0);
  for (const int view : cluster) {
    is_in[view] = 1;
    model.state.board_corners[view] = whole.board_corners[view];
  }
  for (std::size_t t = 0; t < whole.tracks.size(); ++t) AddTrack(whole, t, is_in, model);
  return model;
}

Result<std::vector<ClusterModel>> BuildClusterModels(const SfmState& whole,
                                                     const std::vector<std::vector<int>>& clusters,
                                                     const MatchGraph& matches,
                                                     const std::vector<std::optional<Rigid3>>& board_poses,
                                                     const SparseOptions& options, const RunParts& run_parts,
                                                     const RunContext& context) {
  std::vector<ClusterModel> models(clusters.size());
  std::vector<ClusterWork> work(clusters.size());
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    models[c] = RestrictTo(whole, clusters[c]);
    work[c] = WorkOf(whole, clusters[c], matches, board_poses, context);
  }
  if (options.parts && run_parts) {
    DRUPE_RETURN_IF_ERROR(BuildInParts(work, options, run_parts, context, models));
    return models;
  }
  RunContext one_thread = context;  // threads go over clusters, not into them
  one_thread.threads = 1;
  one_thread.progress = nullptr;
  std::vector<Status> statuses(clusters.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, clusters.size(), [&](std::size_t c) {
    statuses[c] = Build(work[c], options, one_thread, models[c].state);
  }));
  for (const Status& status : statuses) DRUPE_RETURN_IF_ERROR(status);
  return models;
}

Result<std::string> RunSparsePart(std::string_view part, const SparseOptions& options, const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_ASSIGN_OR_RETURN(ClusterWork work, ReadClusterWork(part));
  RunContext silent = context;
  silent.progress = nullptr;
  silent.seed = work.seed;
  DRUPE_RETURN_IF_ERROR(Build(work, options, silent, work.state));
  return WriteSfmState(work.state);
}

}  // namespace drupe
