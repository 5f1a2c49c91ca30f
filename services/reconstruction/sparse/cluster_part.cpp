#include "reconstruction/sparse/cluster_part.h"

#include <algorithm>
#include <array>

#include "scene/archive.h"
#include "scene/view_graph_archive.h"

namespace drupe {

// Found by the archive through their arguments, therefore in their namespace.

template <typename Archive>
void Fields(Archive& archive, PinholeCamera& camera) {
  archive(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, camera.dist);
}

template <typename Archive>
void Fields(Archive& archive, ImageMeasurement& measured) {
  archive(measured.pixel, measured.xy, measured.pixel_from_normalised);
}

template <typename Archive>
void Fields(Archive& archive, SfmObservation& observation) {
  archive(observation.view, observation.track, observation.keypoint, observation.is_active, observation.sigma_px,
          observation.measured);
}

template <typename Archive>
void Fields(Archive& archive, SfmTrack& track) {
  archive(track.begin, track.end, track.has_position, track.position, track.share);
}

template <typename Archive>
void Fields(Archive& archive, BoardCorner& corner) {
  archive(corner.planned, corner.outward, corner.measured);
}

template <typename Archive>
void Fields(Archive& archive, SfmState& state) {
  archive(state.camera, state.observations, state.tracks, state.view_observations, state.board_corners, state.poses,
          state.reasons, state.is_metric, state.ink_spread_mm);
}

template <typename Archive>
void Fields(Archive& archive, ClusterWork& work) {
  archive(work.state, work.cluster, work.matches.pairs, work.board_poses, work.seed);
}

namespace {

Status BadClusterPart(const std::string& why) {
  return Unprocessable("bad_part", "the part of a reconstruction cannot be read: " + why);
}

/// Every index is looked at before it is believed.
Status CheckState(const SfmState& state) {
  const std::size_t views = state.poses.size();
  if (state.view_observations.size() != views || state.board_corners.size() != views || state.reasons.size() != views) {
    return BadClusterPart("its views do not agree");
  }
  for (const SfmObservation& observation : state.observations) {
    if (observation.view < 0 || static_cast<std::size_t>(observation.view) >= views || observation.track < 0 ||
        static_cast<std::size_t>(observation.track) >= state.tracks.size()) {
      return BadClusterPart("an observation is of no view or track");
    }
  }
  for (const SfmTrack& track : state.tracks) {
    if (track.begin > track.end || track.end > state.observations.size()) return BadClusterPart("a track has no end");
  }
  for (const auto& seen : state.view_observations) {
    const bool known =
        std::all_of(seen.begin(), seen.end(), [&](std::size_t o) { return o < state.observations.size(); });
    if (!known) return BadClusterPart("a view has an observation that is not there");
  }
  return Status::Ok();
}

}  // namespace

std::string WriteClusterWork(ClusterWork& work) {
  ArchiveWriter writer;
  writer(work);
  return writer.Take();
}

Result<ClusterWork> ReadClusterWork(std::string_view part) {
  ClusterWork work;
  ArchiveReader reader(part);
  reader(work);
  if (!reader.Complete()) return BadClusterPart("its length is wrong");
  DRUPE_RETURN_IF_ERROR(CheckState(work.state));
  const auto views = static_cast<int>(work.state.poses.size());
  const auto is_view = [&](int view) { return view >= 0 && view < views; };
  bool known = work.board_poses.size() == work.state.poses.size() &&
               std::all_of(work.cluster.begin(), work.cluster.end(), is_view);
  for (const TwoViewMatches& pair : work.matches.pairs) {
    known = known && is_view(pair.pair.first) && is_view(pair.pair.second);
  }
  if (!known) return BadClusterPart("it names a view that is not there");
  return work;
}

std::string WriteSfmState(SfmState& state) {
  ArchiveWriter writer;
  writer(state);
  return writer.Take();
}

Result<SfmState> ReadSfmState(std::string_view bytes, const SfmState& sent) {
  SfmState state;
  ArchiveReader reader(bytes);
  reader(state);
  if (!reader.Complete()) return BadClusterPart("its length is wrong");
  if (state.poses.size() != sent.poses.size() || state.tracks.size() != sent.tracks.size() ||
      state.observations.size() != sent.observations.size()) {
    return BadClusterPart("it is about something else");
  }
  DRUPE_RETURN_IF_ERROR(CheckState(state));
  return state;
}

}  // namespace drupe
