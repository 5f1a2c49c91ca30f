#include "reconstruction/sparse/track_triangulation.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace drupe {
namespace {

constexpr std::size_t kTracksAChunk = 512;
constexpr std::size_t kMaxPairs = 20;  // pairs of rays tried for a track that holds a wrong observation
constexpr double kKeepShare = 0.75;    // of the registered observations must agree for a position to stay

/// The registered observations of one track.
struct Rays {
  std::vector<SfmObservation*> observations;
  std::vector<RayObservation> rays;
};

Rays RegisteredRays(SfmState& state, SfmTrack& track) {
  Rays all;
  for (SfmObservation& observation : state.ObservationsOf(track)) {
    observation.is_active = false;
    if (!state.poses[observation.view]) continue;
    all.observations.push_back(&observation);
    all.rays.push_back({*state.poses[observation.view], observation.measured.xy});
  }
  return all;
}

bool Agrees(const Rays& all, std::size_t i, const Eigen::Vector3d& point, double max_error_px) {
  return ErrorPx(all.rays[i].cam_from_world, all.observations[i]->measured, point) <= max_error_px;
}

int CountAgreeing(const Rays& all, const Eigen::Vector3d& point, double max_error_px) {
  int count = 0;
  for (std::size_t i = 0; i < all.rays.size(); ++i) count += Agrees(all, i, point, max_error_px) ? 1 : 0;
  return count;
}

/// The point from the pair of rays that most others agree with. Pairs far apart in the track come first: their rays
/// meet at the widest angle.
std::optional<Eigen::Vector3d> BestOfPairs(const Rays& all, double max_error_px) {
  std::optional<Eigen::Vector3d> best;
  int best_count = 1;
  std::size_t tried = 0;
  for (std::size_t gap = all.rays.size() - 1; gap > 0 && tried < kMaxPairs; --gap) {
    for (std::size_t i = 0; i + gap < all.rays.size() && tried < kMaxPairs; ++i, ++tried) {
      const RayObservation pair[] = {all.rays[i], all.rays[i + gap]};
      const auto point = Triangulate(pair);
      if (!point) continue;
      const int count = CountAgreeing(all, *point, max_error_px);
      if (count > best_count) best_count = count, best = point;
    }
  }
  return best;
}

std::vector<RayObservation> AgreeingRays(const Rays& all, const Eigen::Vector3d& point, double max_error_px) {
  std::vector<RayObservation> agreeing;
  for (std::size_t i = 0; i < all.rays.size(); ++i) {
    if (Agrees(all, i, point, max_error_px)) agreeing.push_back(all.rays[i]);
  }
  return agreeing;
}

std::optional<Eigen::Vector3d> TriangulateRobustly(const Rays& all, double max_error_px) {
  const auto from_all = Triangulate(all.rays);
  if (from_all && CountAgreeing(all, *from_all, max_error_px) == static_cast<int>(all.rays.size())) return from_all;
  if (all.rays.size() == 2) return std::nullopt;
  const auto from_pair = BestOfPairs(all, max_error_px);
  if (!from_pair) return std::nullopt;
  const auto refined = Triangulate(AgreeingRays(all, *from_pair, max_error_px));
  return refined ? refined : from_pair;
}

void UpdateTrack(SfmState& state, SfmTrack& track, const TriangulationOptions& options) {
  const Rays all = RegisteredRays(state, track);
  const bool had_position = track.has_position;
  track.has_position = false;
  if (all.rays.size() < 2) return;
  const bool keeps = had_position && CountAgreeing(all, track.position, options.max_error_px) >=
                                         std::max(2.0, kKeepShare * static_cast<double>(all.rays.size()));
  if (!keeps) {
    const auto point = TriangulateRobustly(all, options.max_error_px);
    if (!point) return;
    track.position = *point;
  }
  const std::vector<RayObservation> agreeing = AgreeingRays(all, track.position, options.max_error_px);
  if (agreeing.size() < 2 || SmallestRayCosine(agreeing, track.position) > std::cos(options.min_angle_rad)) return;
  track.has_position = true;
  for (std::size_t i = 0; i < all.rays.size(); ++i) {
    all.observations[i]->is_active = Agrees(all, i, track.position, options.max_error_px);
  }
}

}  // namespace

Status UpdateTracks(SfmState& state, const TriangulationOptions& options, const RunContext& context) {
  const std::size_t chunks = (state.tracks.size() + kTracksAChunk - 1) / kTracksAChunk;
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, chunks, [&](std::size_t chunk) {
    const std::size_t end = std::min(state.tracks.size(), (chunk + 1) * kTracksAChunk);
    for (std::size_t t = chunk * kTracksAChunk; t < end; ++t) UpdateTrack(state, state.tracks[t], options);
  }));
  return context.CheckCancelled();
}

int CountPositions(const SfmState& state) {
  return static_cast<int>(std::count_if(state.tracks.begin(), state.tracks.end(),
                                        [](const SfmTrack& track) { return track.has_position; }));
}

}  // namespace drupe
