#include "reconstruction/sparse/placement.h"

#include <algorithm>

#include "reconstruction/sparse/board_frame.h"
#include "reconstruction/sparse/incremental.h"
#include "reconstruction/sparse/initial_pair.h"

namespace drupe {
namespace {

/// From this share of the views on, the board alone places the first ones; below, features begin and the board joins.
constexpr double kBoardFirstShare = 0.6;

int CountPoses(const std::vector<std::optional<Rigid3>>& poses) {
  return static_cast<int>(std::count_if(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); }));
}

bool StartFromBoard(const std::vector<std::optional<Rigid3>>& board_poses, const SparseOptions& options,
                    SfmState& state) {
  if (CountPoses(board_poses) < options.min_board_views) return false;
  state.poses = board_poses;
  state.is_metric = true;
  return true;
}

}  // namespace

Status PlaceViews(const MatchGraph& matches, const std::vector<std::optional<Rigid3>>& board_poses, int view_count,
                  const SparseOptions& options, const RunContext& context, SfmState& state) {
  const bool board_first = CountPoses(board_poses) >= kBoardFirstShare * view_count;
  if (!(board_first && StartFromBoard(board_poses, options, state))) {
    const Status started = StartFromPair(matches, options, context, state);
    if (!started.ok() && (started.code() != "no_initial_pair" || !StartFromBoard(board_poses, options, state))) {
      return started;
    }
  }
  DRUPE_RETURN_IF_ERROR(GrowModel(board_poses, options, context, state));
  if (state.is_metric || !AlignToBoard(board_poses, options, state)) return Status::Ok();
  return GrowModel(board_poses, options, context, state);  // the board may now place what features could not
}

}  // namespace drupe
