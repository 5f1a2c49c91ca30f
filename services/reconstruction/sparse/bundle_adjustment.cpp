#include "reconstruction/sparse/bundle_adjustment.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/sparse/distributed_adjustment.h"
#include "reconstruction/sparse/linearised_observation.h"
#include "reconstruction/sparse/monolithic_adjustment.h"

namespace drupe {
namespace {

double RobustSigma(std::vector<double>& absolute) {
  if (absolute.empty()) return 0;
  constexpr double kMadToSigma = 1.4826;
  const auto middle = absolute.begin() + static_cast<std::ptrdiff_t>(absolute.size() / 2);
  std::nth_element(absolute.begin(), middle, absolute.end());
  return kMadToSigma * *middle;
}

void AppendResidual(const Rigid3& pose, const ImageMeasurement& measured, const Eigen::Vector3d& point, double sigma_px,
                    std::vector<double>& absolute) {
  const Eigen::Vector3d p = pose * point;
  if (p.z() <= 0) return;
  const Eigen::Vector2d residual = measured.pixel_from_normalised * (p.hnormalized() - measured.xy) / sigma_px;
  absolute.push_back(std::abs(residual.x()));
  absolute.push_back(std::abs(residual.y()));
}

}  // namespace

AdjustmentScope AdjustmentScope::Everything(const SfmState& state) {
  AdjustmentScope scope;
  for (const auto& pose : state.poses) scope.view_moves.push_back(pose.has_value() ? 1 : 0);
  return scope;
}

Status AdjustBundle(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options,
                    const RunContext& context) {
  const bool distributed = options.method == AdjustmentMethod::kDistributed && !options.refine_intrinsics;
  return distributed ? AdjustDistributed(state, scope, options, context)
                     : AdjustMonolithic(state, scope, options, context);
}

double AdjustmentCost(const SfmState& state, const AdjustmentOptions& options) {
  const CauchyLoss feature_loss(options.feature_loss_px / options.feature_sigma_px);
  const CauchyLoss board_loss(options.board_loss_px / options.board_sigma_px);
  double cost = 0;
  for (const SfmObservation& o : state.observations) {
    const SfmTrack& track = state.tracks[o.track];
    if (!o.is_active || !track.has_position) continue;
    const double error =
        ErrorPx(*state.poses[o.view], o.measured, track.position) / (options.feature_sigma_px * o.sigma_px);
    cost += 0.5 * feature_loss.Value(error * error);
  }
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!state.is_metric || !state.poses[v]) continue;
    for (const BoardCorner& corner : state.board_corners[v]) {
      const Eigen::Vector3d point = corner.planned + state.ink_spread_mm * corner.outward;
      const double error = ErrorPx(*state.poses[v], corner.measured, point) / options.board_sigma_px;
      cost += 0.5 * board_loss.Value(error * error);
    }
  }
  return cost;
}

NoiseLevels EstimateNoise(const SfmState& state) {
  std::vector<double> features, corners;
  for (const SfmObservation& observation : state.observations) {
    const SfmTrack& track = state.tracks[observation.track];
    if (!observation.is_active || !track.has_position) continue;
    AppendResidual(*state.poses[observation.view], observation.measured, track.position, observation.sigma_px,
                   features);
  }
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!state.is_metric || !state.poses[v]) continue;
    for (const BoardCorner& corner : state.board_corners[v]) {
      const Eigen::Vector3d printed = corner.planned + state.ink_spread_mm * corner.outward;
      AppendResidual(*state.poses[v], corner.measured, printed, 1.0, corners);
    }
  }
  return {RobustSigma(features), RobustSigma(corners)};
}

}  // namespace drupe
