#include "reconstruction/sparse/adjustment_layout.h"

#include <algorithm>
#include <map>

namespace drupe {
namespace {

/// Views that move: those of the scope but for the gauge.
std::vector<std::uint8_t> MovingViews(const SfmState& state, const AdjustmentScope& scope) {
  std::vector<std::uint8_t> moves(state.ViewCount(), 0);
  bool all_move = true;
  int first = -1;
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!state.poses[v]) continue;
    if (first < 0) first = v;
    moves[v] = scope.view_moves[v];
    all_move = all_move && moves[v];
  }
  if (all_move && first >= 0 && !state.is_metric) moves[first] = 0;
  return moves;
}

/// Tracks that an active observation ties to a moving view, by share.
std::map<int, TrackShare> TouchedTracks(const SfmState& state, const std::vector<std::uint8_t>& moves) {
  std::map<int, TrackShare> shares;
  for (std::size_t t = 0; t < state.tracks.size(); ++t) {
    const SfmTrack& track = state.tracks[t];
    if (!track.has_position) continue;
    const auto observations = state.ObservationsOf(track);
    const bool is_touched = std::any_of(observations.begin(), observations.end(),
                                        [&](const SfmObservation& o) { return o.is_active && moves[o.view]; });
    if (is_touched) shares[track.share].tracks.push_back(static_cast<int>(t));
  }
  return shares;
}

void CollectViews(const SfmState& state, const std::vector<std::uint8_t>& moves, TrackShare& share) {
  std::vector<std::uint8_t> is_seen(state.ViewCount(), 0);
  for (const int t : share.tracks) {
    for (const SfmObservation& o : state.ObservationsOf(state.tracks[t])) {
      if (o.is_active && moves[o.view]) is_seen[o.view] = 1;
    }
  }
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (is_seen[v]) share.views.push_back(v);
  }
}

/// Gives each view's board corners to the first share that touches the view, or to the first of all.
void DealBoard(const SfmState& state, AdjustmentLayout& layout) {
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!layout.moves[v] || state.board_corners[v].empty()) continue;
    layout.moves_ink = true;
    if (layout.shares.empty()) layout.shares.emplace_back();
    const auto holds = [v](const TrackShare& s) { return std::binary_search(s.views.begin(), s.views.end(), v); };
    auto share = std::find_if(layout.shares.begin(), layout.shares.end(), holds);
    if (share == layout.shares.end()) {
      share = layout.shares.begin();
      share->views.insert(std::lower_bound(share->views.begin(), share->views.end(), v), v);
    }
    share->board_views.push_back(v);
  }
}

void FindShared(int view_count, bool all_shared, AdjustmentLayout& layout) {
  std::vector<int> touching(view_count, 0);
  for (const TrackShare& share : layout.shares) {
    for (const int v : share.views) ++touching[v];
  }
  layout.place_of_shared.assign(view_count, -1);
  const int fewest = all_shared ? 1 : 2;
  for (int v = 0; v < view_count; ++v) {
    if (touching[v] < fewest) continue;
    layout.place_of_shared[v] = static_cast<int>(layout.shared_views.size());
    layout.shared_views.push_back(v);
  }
  for (TrackShare& share : layout.shares) {
    const auto inner_end = std::stable_partition(share.views.begin(), share.views.end(),
                                                 [&](int v) { return layout.place_of_shared[v] < 0; });
    share.inner_count = static_cast<int>(inner_end - share.views.begin());
  }
}

}  // namespace

AdjustmentLayout LayOut(const SfmState& state, const AdjustmentScope& scope, bool all_shared) {
  AdjustmentLayout layout;
  layout.moves = MovingViews(state, scope);
  for (auto& [number, share] : TouchedTracks(state, layout.moves)) {
    CollectViews(state, layout.moves, share);
    layout.shares.push_back(std::move(share));
  }
  if (state.is_metric) DealBoard(state, layout);
  FindShared(state.ViewCount(), all_shared, layout);
  return layout;
}

}  // namespace drupe
