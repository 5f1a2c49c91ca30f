#include "reconstruction/sparse/share_elimination.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/positive_solve.h"

namespace drupe {
namespace {

constexpr double kSmallestDiagonal = 1e-6;  // a parameter that nothing determines still has a damped equation

/// Corner of the board as printed.
Eigen::Vector3d Printed(const BoardCorner& corner, double ink_spread_mm) {
  return corner.planned + ink_spread_mm * corner.outward;
}

/// Weighs an observation by its loss (iteratively reweighted least squares) and returns its cost.
double ApplyLoss(const CauchyLoss& loss, LinearisedObservation& observation) {
  const double squared = observation.residual.squaredNorm();
  const double root = std::sqrt(loss.Weight(squared));
  observation.residual *= root;
  observation.by_pose *= root;
  observation.by_point *= root;
  return 0.5 * loss.Value(squared);
}

double SquaredResidual(const Rigid3& pose, const ImageMeasurement& measured, double sigma_px,
                       const Eigen::Vector3d& point) {
  const double error = ErrorPx(pose, measured, point) / sigma_px;
  return error * error;
}

}  // namespace

ShareElimination::ShareElimination(const SfmState& state, const AdjustmentLayout& layout, const TrackShare& share,
                                   const AdjustmentOptions& options)
    : state_(state),
      layout_(layout),
      share_(share),
      options_(options),
      feature_loss_(options.feature_loss_px / options.feature_sigma_px),
      board_loss_(options.board_loss_px / options.board_sigma_px),
      place_(state.ViewCount(), -1) {
  for (std::size_t k = 0; k < share.views.size(); ++k) place_[share.views[k]] = static_cast<int>(k);
  const Eigen::Index size = InkPlace() + (layout.moves_ink ? 1 : 0);
  normal_.resize(size, size);
  gradient_.resize(size);
  diagonal_.resize(size);
  step_.resize(size);
}

Eigen::Matrix3d ShareElimination::TrackEquations::DampedInverse(double damping) const {
  Eigen::Matrix3d damped = normal;
  for (int k = 0; k < 3; ++k) damped(k, k) += damping * std::max(kSmallestDiagonal, normal(k, k));
  return damped.inverse();
}

void ShareElimination::FormTrack(const SfmTrack& track, TrackEquations& equations) const {
  equations.normal.setZero();
  equations.gradient.setZero();
  equations.ties.clear();
  equations.cost = 0;
  for (const SfmObservation& o : state_.ObservationsOf(track)) {
    if (!o.is_active) continue;
    Tie tie{place_[o.view], {}};
    const double sigma = options_.feature_sigma_px * o.sigma_px;
    if (!LineariseObservation(*state_.poses[o.view], o.measured, sigma, track.position, tie.observation)) continue;
    equations.cost += ApplyLoss(feature_loss_, tie.observation);
    const auto& by_point = tie.observation.by_point;
    equations.normal.noalias() += by_point.transpose() * by_point;
    equations.gradient.noalias() += by_point.transpose() * tie.observation.residual;
    if (tie.place >= 0) equations.ties.push_back(tie);
  }
}

void ShareElimination::EliminateTrack(const TrackEquations& equations, double damping) {
  const Eigen::Matrix3d inverse = equations.DampedInverse(damping);
  const Eigen::Vector3d point_step = inverse * equations.gradient;
  couplings_.clear();
  for (const Tie& tie : equations.ties) {
    couplings_.push_back(tie.observation.by_pose.transpose() * tie.observation.by_point);
  }
  for (std::size_t a = 0; a < equations.ties.size(); ++a) {
    const LinearisedObservation& observation = equations.ties[a].observation;
    const Eigen::Matrix<double, 6, 6> own = observation.by_pose.transpose() * observation.by_pose;
    const Matrix63 eliminated = couplings_[a] * inverse;
    const int row = 6 * equations.ties[a].place;
    normal_.block<6, 6>(row, row) += own;
    diagonal_.segment<6>(row) += own.diagonal();
    gradient_.segment<6>(row).noalias() +=
        observation.by_pose.transpose() * observation.residual - couplings_[a] * point_step;
    for (std::size_t b = 0; b < equations.ties.size(); ++b) {
      const int column = 6 * equations.ties[b].place;
      if (column <= row) normal_.block<6, 6>(row, column).noalias() -= eliminated * couplings_[b].transpose();
    }
  }
}

void ShareElimination::AddCorners(int view) {
  const int row = 6 * place_[view], ink = InkPlace();
  for (const BoardCorner& corner : state_.board_corners[view]) {
    LinearisedObservation o;
    const Eigen::Vector3d point = Printed(corner, state_.ink_spread_mm);
    if (!LineariseObservation(*state_.poses[view], corner.measured, options_.board_sigma_px, point, o)) continue;
    cost_ += ApplyLoss(board_loss_, o);
    const Eigen::Vector2d by_ink = o.by_point * corner.outward;
    normal_.block<6, 6>(row, row).noalias() += o.by_pose.transpose() * o.by_pose;
    normal_.block<1, 6>(ink, row).noalias() += by_ink.transpose() * o.by_pose;
    normal_(ink, ink) += by_ink.squaredNorm();
    diagonal_.segment<6>(row) += o.by_pose.colwise().squaredNorm().transpose();
    diagonal_[ink] += by_ink.squaredNorm();
    gradient_.segment<6>(row).noalias() += o.by_pose.transpose() * o.residual;
    gradient_[ink] += by_ink.dot(o.residual);
  }
}

void ShareElimination::Linearise(double damping) {
  normal_.setZero();
  gradient_.setZero();
  diagonal_.setZero();
  cost_ = 0;
  TrackEquations equations;
  for (const int t : share_.tracks) {
    FormTrack(state_.tracks[t], equations);
    cost_ += equations.cost;
    EliminateTrack(equations, damping);
  }
  for (const int view : share_.board_views) AddCorners(view);
}

bool ShareElimination::EliminateInner(double damping) {
  const Eigen::Index inner = 6 * share_.inner_count, shared = normal_.rows() - inner;
  if (inner == 0) return true;
  Eigen::MatrixXd own = normal_.topLeftCorner(inner, inner);
  own.diagonal() += damping * diagonal_.head(inner).cwiseMax(kSmallestDiagonal);
  if (!FactorPositive(own)) return false;
  const auto coupling = normal_.bottomLeftCorner(shared, inner);
  inner_by_shared_ = coupling.transpose();
  SolveFactored(own, inner_by_shared_);
  inner_gradient_ = gradient_.head(inner);
  SolveFactored(own, inner_gradient_);
  inner_decrement_ = gradient_.head(inner).dot(inner_gradient_);
  normal_.bottomRightCorner(shared, shared) -= coupling * inner_by_shared_;
  gradient_.tail(shared) -= coupling * inner_gradient_;
  return true;
}

void ShareElimination::AddReduced(Eigen::MatrixXd& normal, Eigen::VectorXd& gradient, Eigen::VectorXd& diagonal) const {
  const int views = static_cast<int>(share_.views.size()), ink = InkPlace();
  const Eigen::Index whole_ink = 6 * static_cast<Eigen::Index>(layout_.shared_views.size());
  const auto place_of = [this](int k) { return 6 * layout_.place_of_shared[share_.views[k]]; };
  for (int a = share_.inner_count; a < views; ++a) {
    const int row = place_of(a);
    gradient.segment<6>(row) += gradient_.segment<6>(6 * a);
    diagonal.segment<6>(row) += diagonal_.segment<6>(6 * a);
    // Shared views ascend in both orders, so the lower triangle stays the lower one.
    for (int b = share_.inner_count; b <= a; ++b) {
      normal.block<6, 6>(row, place_of(b)) += normal_.block<6, 6>(6 * a, 6 * b);
    }
    if (layout_.moves_ink) normal.block<1, 6>(whole_ink, row) += normal_.block<1, 6>(ink, 6 * a);
  }
  if (!layout_.moves_ink) return;
  normal(whole_ink, whole_ink) += normal_(ink, ink);
  gradient[whole_ink] += gradient_[ink];
  diagonal[whole_ink] += diagonal_[ink];
}

void ShareElimination::SolveInner(const Eigen::VectorXd& shared_step) {
  for (std::size_t k = share_.inner_count; k < share_.views.size(); ++k) {
    step_.segment<6>(6 * static_cast<Eigen::Index>(k)) =
        shared_step.segment<6>(6 * layout_.place_of_shared[share_.views[k]]);
  }
  if (layout_.moves_ink) step_[InkPlace()] = shared_step[shared_step.size() - 1];
  const Eigen::Index inner = 6 * share_.inner_count;
  if (inner == 0) return;
  step_.head(inner) = -inner_gradient_ - inner_by_shared_ * step_.tail(step_.size() - inner);
}

double ShareElimination::TrackCost(const SfmTrack& track, const std::vector<Rigid3>& poses,
                                   const Eigen::Vector3d& position) const {
  double cost = 0;
  for (const SfmObservation& o : state_.ObservationsOf(track)) {
    if (!o.is_active) continue;
    const double sigma = options_.feature_sigma_px * o.sigma_px;
    cost += 0.5 * feature_loss_.Value(SquaredResidual(poses[o.view], o.measured, sigma, position));
  }
  return cost;
}

double ShareElimination::CornerCost(int view, const Rigid3& pose, double ink_spread_mm) const {
  double cost = 0;
  for (const BoardCorner& corner : state_.board_corners[view]) {
    const Eigen::Vector3d point = Printed(corner, ink_spread_mm);
    cost += 0.5 * board_loss_.Value(SquaredResidual(pose, corner.measured, options_.board_sigma_px, point));
  }
  return cost;
}

double ShareElimination::MoveTracks(double damping, const std::vector<Rigid3>& poses, double ink_spread_mm,
                                    std::vector<Eigen::Vector3d>& positions) const {
  double cost = 0;
  TrackEquations equations;
  for (const int t : share_.tracks) {
    const SfmTrack& track = state_.tracks[t];
    FormTrack(track, equations);
    Eigen::Vector3d gradient = equations.gradient;
    for (const Tie& tie : equations.ties) {
      const Eigen::Vector2d moved = tie.observation.by_pose * StepOf(tie.place);
      gradient.noalias() += tie.observation.by_point.transpose() * moved;
    }
    positions[t] = track.position - equations.DampedInverse(damping) * gradient;
    cost += TrackCost(track, poses, positions[t]);
  }
  for (const int view : share_.board_views) cost += CornerCost(view, poses[view], ink_spread_mm);
  return cost;
}

Eigen::Matrix3d ShareElimination::TrackCovariance(int track, const Eigen::MatrixXd& shared_covariance) const {
  TrackEquations equations;
  FormTrack(state_.tracks[track], equations);
  const auto place_of = [this](const Tie& tie) { return 6 * layout_.place_of_shared[share_.views[tie.place]]; };
  Eigen::Matrix3d from_views = Eigen::Matrix3d::Zero();
  for (const Tie& a : equations.ties) {
    Matrix63 moved = Matrix63::Zero();  // what the other views' steps do to the track, as seen from a
    for (const Tie& b : equations.ties) {
      const Matrix63 coupling = b.observation.by_pose.transpose() * b.observation.by_point;
      moved.noalias() += shared_covariance.block<6, 6>(place_of(a), place_of(b)) * coupling;
    }
    from_views.noalias() += (a.observation.by_pose.transpose() * a.observation.by_point).transpose() * moved;
  }
  const Eigen::Matrix3d own = equations.DampedInverse(0);
  return own + own * from_views * own;
}

}  // namespace drupe
