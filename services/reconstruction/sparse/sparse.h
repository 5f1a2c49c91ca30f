#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/run_context.h"
#include "base/stage_parts.h"
#include "base/status.h"
#include "geometry/pinhole_camera.h"
#include "reconstruction/sparse/sparse_options.h"
#include "scene/board.h"
#include "scene/features.h"
#include "scene/sparse_model.h"
#include "scene/view_graph.h"

namespace drupe {

/// What structure from motion starts from. Everything is borrowed for the duration of RunSparse.
struct SparseInput {
  std::span<const std::string> image_names;
  std::span<const Features> features;      ///< one an image; descriptors are read by options.complete_tracks alone
  const MatchGraph* matches = nullptr;     ///< verified pairs; chooses where to begin
  const TrackList* tracks = nullptr;       ///< one keypoint a view, over all pairs
  const ViewClusters* clusters = nullptr;  ///< for SparseMethod::kClusters; may be null
  PinholeCamera camera;
  IntrinsicsSource intrinsics_source = IntrinsicsSource::kGiven;
  bool refine_intrinsics = false;  ///< focal length and radial distortion enter the final adjustment
  std::optional<Board> board;
  std::span<const BoardDetection> detections;  ///< one an image; empty without a board
  RunParts run_parts = nullptr;                ///< for options.parts; empty: everything is done here
};

/// Structure from motion (paper 3.1.2): every cluster incrementally on its own (initial pair, camera poses,
/// triangulation, adjustment, repeated until no view can be added), the models fused along the maximum spanning tree,
/// then tracks triangulated again and all adjusted at once, tracks completed by what matching missed, and all adjusted;
/// or, with one cluster or SparseMethod::kWhole, one model grown from one pair. With a board seen in at least
/// `min_board_views` views the result is in the board's frame, mm; otherwise in an arbitrary frame. Views that cannot
/// be placed stay in the model with the reason.
///
/// Reports stage "sparse". Deterministic for equal input, options and seed, whatever the thread count. Errors: 400 for
/// options out of range or sizes that do not fit together, 422 `no_initial_pair` and `too_few_registered` (less than
/// `min_registered_share` of the views) with what to change on the rig, `cancelled`.
Result<SparseModel> RunSparse(const SparseInput& input, const SparseOptions& options, const RunContext& context);

/// Does one of the parts that RunSparse gave to run_parts, with the options that it had: the same bytes wherever this
/// build runs. Errors: 422 `bad_part`, `cancelled`, 500 `adjustment_failed`.
Result<std::string> RunSparsePart(std::string_view part, const SparseOptions& options, const RunContext& context);

}  // namespace drupe
