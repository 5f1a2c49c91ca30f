#pragma once

#include <Eigen/Core>
#include <vector>

#include "reconstruction/sparse/adjustment_layout.h"
#include "reconstruction/sparse/linearised_observation.h"

namespace drupe {

/// The work of one share of a distributed adjustment: its tracks and its inner views are eliminated from the normal
/// equations (Brown 1976; Triggs et al. 2000, section 6), and what is left speaks of the shared views alone. Nothing
/// else has to leave the share, and the sum over all shares is the exact reduced system of the whole.
///
/// Parameters in order: a PoseStep of every view of the share (inner, then shared), then the ink spread if it moves.
class ShareElimination {
 public:
  ShareElimination(const SfmState& state, const AdjustmentLayout& layout, const TrackShare& share,
                   const AdjustmentOptions& options);

  /// Normal equations at the state, tracks eliminated under the damping (Levenberg-Marquardt, relative to the
  /// diagonal).
  void Linearise(double damping);
  /// Eliminates the inner views too. False when they are not determined.
  bool EliminateInner(double damping);
  /// Adds the equations of the shared parameters, lower triangle, to those of the whole: a PoseStep per shared view,
  /// then the ink spread. `diagonal` is the undamped diagonal before elimination.
  void AddReduced(Eigen::MatrixXd& normal, Eigen::VectorXd& gradient, Eigen::VectorXd& diagonal) const;
  /// The step of this share's parameters that belongs to a step of the shared ones.
  void SolveInner(const Eigen::VectorXd& shared_step);
  /// Moves every track by the step that belongs to its views' and returns the cost of the share's residuals at
  /// `poses` (per view) and `ink_spread_mm`; infinite when a point is behind its camera. `positions`: per track.
  double MoveTracks(double damping, const std::vector<Rigid3>& poses, double ink_spread_mm,
                    std::vector<Eigen::Vector3d>& positions) const;
  /// Covariance of a track's position, given that of the shared parameters, when every view is shared: what its rays
  /// leave open, and what the views' own uncertainty adds.
  Eigen::Matrix3d TrackCovariance(int track, const Eigen::MatrixXd& shared_covariance) const;
  /// Step of the k-th view of the share, after SolveInner.
  PoseStep StepOf(int k) const { return step_.segment<6>(6 * k); }
  /// Cost of the share at the state, after Linearise.
  double cost() const { return cost_; }
  /// Squared Newton decrement of the inner views' equations, after EliminateInner: together with that of the shared
  /// ones, the squared step of all views in units of their standard deviations.
  double inner_decrement() const { return inner_decrement_; }

 private:
  using Matrix63 = Eigen::Matrix<double, 6, 3>;

  struct Tie {  ///< an observation by a moving view, weighted by the loss
    int place;  ///< of the view in the share
    LinearisedObservation observation;
  };
  struct TrackEquations {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    std::vector<Tie> ties;
    double cost = 0;

    Eigen::Matrix3d DampedInverse(double damping) const;
  };

  /// The track's own equations and its ties; `equations` is overwritten, its memory reused.
  void FormTrack(const SfmTrack& track, TrackEquations& equations) const;
  void EliminateTrack(const TrackEquations& equations, double damping);
  void AddCorners(int view);
  double TrackCost(const SfmTrack& track, const std::vector<Rigid3>& poses, const Eigen::Vector3d& position) const;
  double CornerCost(int view, const Rigid3& pose, double ink_spread_mm) const;
  int InkPlace() const { return 6 * static_cast<int>(share_.views.size()); }

  const SfmState& state_;
  const AdjustmentLayout& layout_;
  const TrackShare& share_;
  const AdjustmentOptions& options_;
  CauchyLoss feature_loss_, board_loss_;
  std::vector<int> place_;           ///< per view, its place in the share; -1: fixed
  std::vector<Matrix63> couplings_;  ///< of the track at hand, one a tie
  Eigen::MatrixXd normal_;           ///< lower triangle
  Eigen::VectorXd gradient_, diagonal_, step_;
  Eigen::MatrixXd inner_by_shared_;  ///< inverse of the inner block times its coupling
  Eigen::VectorXd inner_gradient_;   ///< inverse of the inner block times its gradient
  double cost_ = 0;
  double inner_decrement_ = 0;
};

}  // namespace drupe
