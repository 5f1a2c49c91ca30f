#include "reconstruction/sparse/stray_tracks.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace drupe {
namespace {

constexpr std::size_t kMinViewTracks = 50;  // of a view, for its depths to mean anything
constexpr double kOuterShare = 0.01;        // at either end
constexpr double kWidening = 0.5;           // of the range, at either end

/// Inverse depths between which a view's scene lies.
struct DepthRange {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool Holds(double inverse_depth) const { return inverse_depth >= low && inverse_depth <= high; }
};

double InverseDepth(const SfmState& state, const SfmObservation& observation) {
  return 1 / (*state.poses[observation.view] * state.tracks[observation.track].position).z();
}

std::ptrdiff_t CountActive(const SfmState& state, const SfmTrack& track) {
  const auto observations = state.ObservationsOf(track);
  return std::count_if(observations.begin(), observations.end(), [](const SfmObservation& o) { return o.is_active; });
}

DepthRange RangeOf(std::vector<double> inverse_depths) {
  if (inverse_depths.size() < kMinViewTracks) return {};
  const auto outer = static_cast<std::ptrdiff_t>(kOuterShare * static_cast<double>(inverse_depths.size()));
  std::sort(inverse_depths.begin(), inverse_depths.end());
  const double low = *(inverse_depths.begin() + outer), high = *(inverse_depths.end() - 1 - outer);
  const double margin = kWidening * (high - low);
  return {low - margin, high + margin};
}

std::vector<DepthRange> RangesOfViews(const SfmState& state) {
  std::vector<std::vector<double>> inverse_depths(state.ViewCount());
  for (const SfmTrack& track : state.tracks) {
    if (!track.has_position || CountActive(state, track) < 3) continue;
    for (const SfmObservation& o : state.ObservationsOf(track)) {
      if (o.is_active) inverse_depths[o.view].push_back(InverseDepth(state, o));
    }
  }
  std::vector<DepthRange> ranges;
  for (std::vector<double>& view : inverse_depths) ranges.push_back(RangeOf(std::move(view)));
  return ranges;
}

}  // namespace

int DropStrayTracks(SfmState& state) {
  const std::vector<DepthRange> ranges = RangesOfViews(state);
  int dropped = 0;
  for (SfmTrack& track : state.tracks) {
    if (!track.has_position || CountActive(state, track) != 2) continue;
    const auto observations = state.ObservationsOf(track);
    const bool is_stray = std::any_of(observations.begin(), observations.end(), [&](const SfmObservation& o) {
      return o.is_active && !ranges[o.view].Holds(InverseDepth(state, o));
    });
    if (!is_stray) continue;
    track.has_position = false;
    for (SfmObservation& o : observations) o.is_active = false;
    ++dropped;
  }
  return dropped;
}

}  // namespace drupe
