#include "reconstruction/sparse/model_from_state.h"

#include <cmath>
#include <numbers>

#include "geometry/sim3.h"
#include "reconstruction/sparse/board_frame.h"

namespace drupe {
namespace {

/// A running mean of reprojection errors.
struct Mean {
  double sum = 0;
  int count = 0;
  void Add(double value) { sum += value, ++count; }
  double Value() const { return count > 0 ? sum / count : 0; }
};

Track TrackFrom(const SfmState& state, const SfmTrack& source, std::vector<Mean>& view_errors) {
  Track track;
  track.position = source.position;
  Mean error;
  for (const SfmObservation& observation : state.ObservationsOf(source)) {
    if (!observation.is_active) continue;
    track.observations.push_back({observation.view, observation.keypoint, observation.measured.pixel.cast<float>()});
    const double error_px = ErrorPx(*state.poses[observation.view], observation.measured, source.position);
    error.Add(error_px);
    view_errors[observation.view].Add(error_px);
  }
  track.mean_reprojection_error_px = error.Value();
  return track;
}

}  // namespace

void NormaliseFrame(SfmState& state) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> centres;
  const Rigid3* first = nullptr;
  for (const auto& pose : state.poses) {
    if (!pose) continue;
    if (first == nullptr) first = &*pose;
    centres.push_back(pose->Centre());
    middle += centres.back();
  }
  if (centres.size() < 2) return;
  middle /= static_cast<double>(centres.size());
  double spread = 0;
  for (const Eigen::Vector3d& centre : centres) spread += (centre - middle).norm();
  if (spread <= 0) return;
  const double scale = static_cast<double>(centres.size()) / spread;
  const Sim3 new_from_old{scale, first->rotation, scale * first->translation};
  for (auto& pose : state.poses) {
    if (pose) pose = TransformPose(*pose, new_from_old);
  }
  for (SfmTrack& track : state.tracks) track.position = new_from_old * track.position;
}

SparseModel ModelFromState(const SparseInput& input, const SfmState& state, const ModelUncertainty& uncertainty) {
  SparseModel model;
  model.camera = state.camera;
  model.intrinsics_source = input.intrinsics_source;
  model.scale_source = state.is_metric ? ScaleSource::kBoard : ScaleSource::kNone;
  std::vector<Mean> view_errors(state.ViewCount());
  for (std::size_t t = 0; t < state.tracks.size(); ++t) {
    if (!state.tracks[t].has_position) continue;
    model.tracks.push_back(TrackFrom(state, state.tracks[t], view_errors));
    model.tracks.back().position_sigma = uncertainty.position_sigma[t];
  }
  Mean all;
  for (int v = 0; v < state.ViewCount(); ++v) {
    View view;
    view.image = input.image_names[v];
    view.cam_from_world = state.poses[v];
    if (!state.poses[v]) view.reason = state.reasons[v];
    view.mean_reprojection_error_px = view_errors[v].Value();
    view.observation_count = view_errors[v].count;
    view.centre_sigma = uncertainty.centre_sigma[v];
    view.rotation_sigma_deg = uncertainty.rotation_sigma_rad[v] * 180 / std::numbers::pi;
    all.sum += view_errors[v].sum, all.count += view_errors[v].count;
    model.views.push_back(std::move(view));
  }
  model.mean_reprojection_error_px = all.Value();
  if (state.is_metric) {
    const BoardResidual board = MeasureBoardResidual(state);
    model.board_rms_px = board.rms_px;
    model.board_observations = board.corners;
  }
  return model;
}

}  // namespace drupe
