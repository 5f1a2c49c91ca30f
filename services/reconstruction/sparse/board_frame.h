#pragma once

#include <cstdint>
#include <optional>

#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// Poses of the views in the board's frame (mm) from their board corners alone, robust to wrong corners. A view has
/// none when fewer than options.min_board_corners agree on a pose, or fewer than half of what it sees.
std::vector<std::optional<Rigid3>> BoardPoses(const SfmState& state, const SparseOptions& options, std::uint64_t seed);

/// Moves a model of arbitrary frame and scale into the board's, by the similarity that brings its cameras to their
/// board poses. False, and the state unchanged, when fewer than options.min_board_views registered views have one, or
/// they stand on one line.
bool AlignToBoard(const std::vector<std::optional<Rigid3>>& board_poses, const SparseOptions& options, SfmState& state);

/// How well the board fixes the scale of a metric state: the relative standard uncertainty of the scale of the rigid
/// structure that the features build, held by the board's corners alone, whose noise is `board_sigma_px`. 0 without
/// them.
double ScaleRelativeSigma(const SfmState& state, double board_sigma_px);

/// Root mean square reprojection error of the board's corners over the registered views, and how many there are.
struct BoardResidual {
  double rms_px = 0;
  int corners = 0;
};
BoardResidual MeasureBoardResidual(const SfmState& state);

}  // namespace drupe
