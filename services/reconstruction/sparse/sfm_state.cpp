#include "reconstruction/sparse/sfm_state.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace drupe {
namespace {

ImageMeasurement Measure(const PinholeCamera& camera, const Eigen::Vector2d& pixel) {
  ImageMeasurement measured;
  measured.pixel = pixel;
  measured.xy = camera.NormalisedFromPixel(pixel);
  camera.PixelFromNormalised(measured.xy, &measured.pixel_from_normalised);
  return measured;
}

void AddTracks(const SparseInput& input, SfmState& state) {
  std::size_t total = 0;
  for (const auto& refs : input.tracks->tracks) total += refs.size();
  state.observations.reserve(total);
  state.tracks.reserve(input.tracks->tracks.size());
  for (const auto& refs : input.tracks->tracks) {
    SfmTrack track;
    track.begin = state.observations.size();
    for (const FeatureRef& ref : refs) {
      SfmObservation observation = MakeObservation(state.camera, ref, input.features[ref.view].keypoints[ref.keypoint]);
      observation.track = static_cast<std::int32_t>(state.tracks.size());
      state.view_observations[ref.view].push_back(state.observations.size());
      state.observations.push_back(observation);
    }
    track.end = state.observations.size();
    state.tracks.push_back(track);
  }
}

std::vector<BoardCorner> BoardCornersOf(const BoardDetection& detection, const Board& board,
                                        const PinholeCamera& camera) {
  std::vector<BoardCorner> corners;
  for (const MarkerDetection& marker : detection) {
    const auto planned = board.corners_mm.find(marker.id);
    if (planned == board.corners_mm.end()) continue;
    const auto& p = planned->second;
    const Eigen::Vector3d middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    const double half_side = 0.5 * (p[1] - p[0]).norm();
    for (int k = 0; k < 4; ++k) {
      corners.push_back({p[k], (p[k] - middle) / half_side, Measure(camera, marker.corners_px[k])});
    }
  }
  return corners;
}

}  // namespace

int SfmState::RegisteredCount() const {
  return static_cast<int>(std::count_if(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); }));
}

SfmState MakeSfmState(const SparseInput& input) {
  SfmState state;
  state.camera = input.camera;
  const std::size_t views = input.image_names.size();
  state.view_observations.resize(views);
  state.board_corners.resize(views);
  state.poses.resize(views);
  state.reasons.resize(views);
  AddTracks(input, state);
  if (input.board && !input.detections.empty()) {
    for (std::size_t v = 0; v < views; ++v) {
      state.board_corners[v] = BoardCornersOf(input.detections[v], *input.board, state.camera);
    }
  }
  return state;
}

float ExpectedSigmaPx(float scale_px) {
  // A blob's centre is found to a share of its size (Zeisl et al. 2009 find it about proportional); small ones hit the
  // pixel's own limit.
  constexpr float kSmallestScalePx = 1.6f;
  return std::max(1.0f, scale_px / kSmallestScalePx);
}

SfmObservation MakeObservation(const PinholeCamera& camera, const FeatureRef& feature, const Keypoint& keypoint) {
  SfmObservation observation;
  observation.view = feature.view;
  observation.keypoint = feature.keypoint;
  observation.sigma_px = ExpectedSigmaPx(keypoint.scale_px);
  observation.measured = Measure(camera, {keypoint.x, keypoint.y});
  return observation;
}

void ShareByOrder(int count, SfmState& state) {
  const std::size_t tracks = state.tracks.size();
  for (std::size_t t = 0; t < tracks; ++t) state.tracks[t].share = static_cast<std::int32_t>(t * count / tracks);
}

void ShareByCluster(const std::vector<std::vector<int>>& clusters, SfmState& state) {
  std::vector<std::vector<int>> clusters_of(state.ViewCount());
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (const int view : clusters[c]) clusters_of[view].push_back(static_cast<int>(c));
  }
  std::vector<int> votes(clusters.size());
  for (SfmTrack& track : state.tracks) {
    std::fill(votes.begin(), votes.end(), 0);
    for (const SfmObservation& observation : state.ObservationsOf(track)) {
      for (const int c : clusters_of[observation.view]) ++votes[c];
    }
    track.share = static_cast<std::int32_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  }
}

void Remeasure(SfmState& state) {
  for (SfmObservation& observation : state.observations) {
    observation.measured = Measure(state.camera, observation.measured.pixel);
  }
  for (std::vector<BoardCorner>& corners : state.board_corners) {
    for (BoardCorner& corner : corners) corner.measured = Measure(state.camera, corner.measured.pixel);
  }
}

double ErrorPx(const Rigid3& cam_from_world, const ImageMeasurement& measured, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = cam_from_world * point;
  if (p.z() <= 0) return std::numeric_limits<double>::infinity();
  return (measured.pixel_from_normalised * (p.head<2>() / p.z() - measured.xy)).norm();
}

}  // namespace drupe
