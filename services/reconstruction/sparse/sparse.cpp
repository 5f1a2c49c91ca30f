#include "reconstruction/sparse/sparse.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "reconstruction/sparse/board_frame.h"
#include "reconstruction/sparse/cluster_models.h"
#include "reconstruction/sparse/focal_from_board.h"
#include "reconstruction/sparse/fusion.h"
#include "reconstruction/sparse/incremental.h"
#include "reconstruction/sparse/model_from_state.h"
#include "reconstruction/sparse/placement.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {
namespace {

/// Parts into which the adjustment of an undivided model is dealt, for threads to work on.
constexpr int kSharesOfAWhole = 8;

Status CheckClusters(const ViewClusters* clusters, int view_count) {
  if (clusters == nullptr) return Status::Ok();
  for (const std::vector<int>& cluster : clusters->clusters) {
    const bool ascends = std::adjacent_find(cluster.begin(), cluster.end(), std::greater_equal<>()) == cluster.end();
    if (ascends && !cluster.empty() && cluster.front() >= 0 && cluster.back() < view_count) continue;
    return InvalidArgument("invalid_sparse_input", "a cluster is not an ascending list of pictures of the set");
  }
  return Status::Ok();
}

Status CheckSizes(const SparseInput& input) {
  const std::size_t views = input.image_names.size();
  if (input.features.size() != views) {
    return InvalidArgument("invalid_sparse_input", "features and image names differ in number");
  }
  if (!input.detections.empty() && input.detections.size() != views) {
    return InvalidArgument("invalid_sparse_input", "board detections and image names differ in number");
  }
  if (input.tracks == nullptr || input.matches == nullptr) {
    return InvalidArgument("invalid_sparse_input", "tracks and matches are needed");
  }
  for (const auto& track : input.tracks->tracks) {
    for (const FeatureRef& ref : track) {
      if (ref.view < 0 || ref.view >= static_cast<int>(views) || ref.keypoint >= input.features[ref.view].size()) {
        return InvalidArgument("invalid_sparse_input", "a track names a feature that does not exist");
      }
    }
  }
  return CheckClusters(input.clusters, static_cast<int>(views));
}

/// A set of several clusters, and the wish to use them.
bool UsesClusters(const SparseInput& input, const SparseOptions& options) {
  return options.method == SparseMethod::kClusters && input.clusters != nullptr && input.clusters->clusters.size() > 1;
}

/// The clusters' models, fused, and in the whole model what they could not place.
Status PlaceByClusters(const SparseInput& input, const std::vector<std::optional<Rigid3>>& board_poses,
                       const SparseOptions& options, const RunContext& context, SfmState& state) {
  const auto& clusters = input.clusters->clusters;
  DRUPE_ASSIGN_OR_RETURN(
      const std::vector<ClusterModel> models,
      BuildClusterModels(state, clusters, *input.matches, board_poses, options, input.run_parts, context));
  context.Report("sparse", 0.5);
  if (!FuseClusters(models, options, context, state)) {
    return PlaceViews(*input.matches, board_poses, state.ViewCount(), options, context, state);
  }
  ShareByCluster(clusters, state);
  if (!state.is_metric) {
    DRUPE_RETURN_IF_ERROR(CloseSeams(options, context, state));
    AlignToBoard(board_poses, options, state);
  }
  return GrowModel(board_poses, options, context, state);
}

/// A guessed focal length gives way to the board's own, where the board shows one.
void ImproveGuess(const SparseInput& input, const SparseOptions& options, SfmState& state) {
  if (input.intrinsics_source == IntrinsicsSource::kGiven) return;
  const auto focal = FocalFromBoard(state, options.min_board_corners);
  if (!focal) return;
  state.camera.fx = state.camera.fy = *focal;
  Remeasure(state);
}

Status CheckRegistered(const SfmState& state, const SparseOptions& options) {
  const int registered = state.RegisteredCount();
  if (registered >= options.min_registered_share * state.ViewCount() && registered >= 2) return Status::Ok();
  return Unprocessable("too_few_registered",
                       "only " + std::to_string(registered) + " of " + std::to_string(state.ViewCount()) +
                           " pictures could be placed; turn the table in smaller steps (10 degrees or less), keep the "
                           "board in view and unhidden, cover the still background, and check focus, exposure and that "
                           "the table has stopped when the camera fires");
}

}  // namespace

Result<SparseModel> RunSparse(const SparseInput& input, const SparseOptions& options, const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_RETURN_IF_ERROR(CheckSizes(input));
  context.Report("sparse", 0);
  SfmState state = MakeSfmState(input);
  ShareByOrder(kSharesOfAWhole, state);
  ImproveGuess(input, options, state);
  const auto board_poses = BoardPoses(state, options, context.seed);
  DRUPE_RETURN_IF_ERROR(UsesClusters(input, options)
                            ? PlaceByClusters(input, board_poses, options, context, state)
                            : PlaceViews(*input.matches, board_poses, state.ViewCount(), options, context, state));
  DRUPE_RETURN_IF_ERROR(CheckRegistered(state, options));
  DRUPE_ASSIGN_OR_RETURN(const NoiseLevels noise, FinishModel(input, options, context, state));
  DRUPE_RETURN_IF_ERROR(CheckRegistered(state, options));
  if (!state.is_metric) NormaliseFrame(state);
  DRUPE_ASSIGN_OR_RETURN(const ModelUncertainty uncertainty,
                         EstimateUncertainty(state, noise, LossesFrom(options), context));
  SparseModel model = ModelFromState(input, state, uncertainty);
  if (state.is_metric) model.scale_relative_sigma = ScaleRelativeSigma(state, noise.board_px);
  context.Report("sparse", 1);
  return model;
}

}  // namespace drupe
