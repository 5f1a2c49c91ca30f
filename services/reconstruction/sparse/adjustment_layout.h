#pragma once

#include <vector>

#include "reconstruction/sparse/bundle_adjustment.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// A cluster's share of an adjustment: the tracks it holds and what their observations touch.
struct TrackShare {
  std::vector<int> tracks;       ///< ascending
  std::vector<int> board_views;  ///< the views whose board corners it holds, ascending
  /// The moving views that its residuals touch: first those that no other share touches, then the shared ones; each
  /// group ascending.
  std::vector<int> views;
  int inner_count = 0;
};

/// Who holds what in an adjustment that is distributed over clusters. Every residual belongs to one share.
struct AdjustmentLayout {
  std::vector<TrackShare> shares;
  std::vector<int> shared_views;     ///< touched by two shares or more, ascending
  std::vector<int> place_of_shared;  ///< per view, its place in shared_views; -1 for others
  std::vector<std::uint8_t> moves;   ///< per view; the gauge does not move
  bool moves_ink = false;            ///< the board's ink spread is a parameter too, one for all shares
};

/// Divides the adjustment of `scope` by SfmTrack::share. The gauge is the board in a metric state; otherwise, where
/// every view would move, the first registered one stays. `all_shared` declares every view shared, so that the reduced
/// equations hold all of them.
AdjustmentLayout LayOut(const SfmState& state, const AdjustmentScope& scope, bool all_shared);

}  // namespace drupe
