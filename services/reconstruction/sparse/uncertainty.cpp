#include "reconstruction/sparse/uncertainty.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>

#include "base/parallel.h"
#include "geometry/positive_solve.h"
#include "reconstruction/sparse/share_elimination.h"

namespace drupe {
namespace {

constexpr double kScaleSigma = 1e-7;  // relative; what holds the scale of a model without a board
constexpr double kNoiseFloorPx = 1e-3;

/// Root of a variance; 0, not known, where rounding or a degenerate place has left none.
double RootOf(double variance) {
  return std::isfinite(variance) && variance > 0 ? std::sqrt(variance) : 0;
}

/// d(centre)/d(PoseStep): the centre is -R^T t, a step turns R and moves t.
Eigen::Matrix<double, 3, 6> CentreByStep(const Rigid3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian.leftCols<3>() = -pose.rotation.transpose() * cross;
  jacobian.rightCols<3>() = -pose.rotation.transpose();
  return jacobian;
}

/// Residuals spread less than the noise, since the model follows them: what the noise is, by the redundancy.
AdjustmentOptions WeightsFrom(const SfmState& state, const NoiseLevels& noise, AdjustmentOptions options) {
  double observations = 0, tracks = 0, corners = 0;
  for (const SfmObservation& o : state.observations) observations += o.is_active ? 1 : 0;
  for (const SfmTrack& track : state.tracks) tracks += track.has_position ? 1 : 0;
  for (int v = 0; v < state.ViewCount() && state.is_metric; ++v) {
    if (state.poses[v]) corners += static_cast<double>(state.board_corners[v].size());
  }
  const double pose_parameters = 6.0 * state.RegisteredCount();
  const auto widening = [](double equations, double parameters) {
    return std::sqrt(equations / std::max(0.1 * equations, equations - parameters));
  };
  const double feature_parameters = 3 * tracks + (state.is_metric ? 0 : pose_parameters);
  options.feature_sigma_px = std::max(kNoiseFloorPx, noise.feature_px);
  options.board_sigma_px = std::max(kNoiseFloorPx, noise.board_px);
  if (observations > 0) options.feature_sigma_px *= widening(2 * observations, feature_parameters);
  if (corners > 0) options.board_sigma_px *= widening(2 * corners, pose_parameters);
  return options;
}

/// The change of scale that a step of the poses makes, as one row: the mean distance of the centres from their middle.
Eigen::VectorXd ScaleRow(const SfmState& state, const AdjustmentLayout& layout) {
  const double n = state.RegisteredCount();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero(), mean_direction = Eigen::Vector3d::Zero();
  for (const auto& pose : state.poses) {
    if (pose) middle += pose->Centre() / n;
  }
  double scale = 0;
  for (const auto& pose : state.poses) {
    if (!pose) continue;
    mean_direction += (pose->Centre() - middle).normalized() / n;
    scale += (pose->Centre() - middle).norm() / n;
  }
  Eigen::VectorXd row(6 * static_cast<Eigen::Index>(layout.shared_views.size()));
  for (std::size_t k = 0; k < layout.shared_views.size(); ++k) {
    const Rigid3& pose = *state.poses[layout.shared_views[k]];
    const Eigen::Vector3d by_centre = ((pose.Centre() - middle).normalized() - mean_direction) / (n * scale);
    row.segment<6>(6 * static_cast<Eigen::Index>(k)) = CentreByStep(pose).transpose() * by_centre;
  }
  return row;
}

/// The work of one estimate.
class Uncertainty {
 public:
  Uncertainty(const SfmState& state, const AdjustmentOptions& options)
      : state_(state), options_(options), layout_(LayOut(state, AdjustmentScope::Everything(state), true)) {
    for (const TrackShare& share : layout_.shares) shares_.emplace_back(state_, layout_, share, options_);
    result_.centre_sigma.assign(state.ViewCount(), 0);
    result_.rotation_sigma_rad.assign(state.ViewCount(), 0);
    result_.position_sigma.assign(state.tracks.size(), 0);
  }

  Result<ModelUncertainty> Run(const RunContext& context) {
    if (layout_.shared_views.empty()) return result_;
    DRUPE_RETURN_IF_ERROR(ParallelFor(context, shares_.size(), [&](std::size_t s) { shares_[s].Linearise(0); }));
    if (!Invert()) return result_;
    FillViews();
    DRUPE_RETURN_IF_ERROR(ParallelFor(context, shares_.size(), [&](std::size_t s) {
      for (const int t : layout_.shares[s].tracks) {
        result_.position_sigma[t] = RootOf(shares_[s].TrackCovariance(t, covariance_).trace());
      }
    }));
    return result_;
  }

 private:
  bool Invert() {
    const Eigen::Index size = 6 * static_cast<Eigen::Index>(layout_.shared_views.size()) + (layout_.moves_ink ? 1 : 0);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size), diagonal = Eigen::VectorXd::Zero(size);
    for (const ShareElimination& share : shares_) share.AddReduced(normal, gradient, diagonal);
    if (!state_.is_metric) {
      const Eigen::VectorXd row = ScaleRow(state_, layout_);
      normal.noalias() += row * row.transpose() / (kScaleSigma * kScaleSigma);
    }
    if (!FactorPositive(normal)) return false;
    covariance_ = Eigen::MatrixXd::Identity(size, size);
    SolveFactored(normal, covariance_);
    return covariance_.allFinite();
  }

  void FillViews() {
    for (std::size_t k = 0; k < layout_.shared_views.size(); ++k) {
      const int view = layout_.shared_views[k];
      const auto start = 6 * static_cast<Eigen::Index>(k);
      const Eigen::Matrix<double, 6, 6> pose = covariance_.block<6, 6>(start, start);
      const Eigen::Matrix<double, 3, 6> centre = CentreByStep(*state_.poses[view]);
      result_.centre_sigma[view] = RootOf((centre * pose * centre.transpose()).trace());
      result_.rotation_sigma_rad[view] = RootOf(pose.topLeftCorner<3, 3>().trace());
    }
  }

  const SfmState& state_;
  const AdjustmentOptions options_;
  const AdjustmentLayout layout_;
  std::deque<ShareElimination> shares_;
  Eigen::MatrixXd covariance_;
  ModelUncertainty result_;
};

}  // namespace

Result<ModelUncertainty> EstimateUncertainty(const SfmState& state, const NoiseLevels& noise,
                                             const AdjustmentOptions& losses, const RunContext& context) {
  return Uncertainty(state, WeightsFrom(state, noise, losses)).Run(context);
}

}  // namespace drupe
