#include "reconstruction/sparse/distributed_adjustment.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "geometry/positive_solve.h"
#include "reconstruction/sparse/banded_cholesky.h"
#include "reconstruction/sparse/share_elimination.h"

namespace drupe {
namespace {

constexpr double kFirstDamping = 1e-4;
constexpr double kLeastDamping = 1e-9;
constexpr double kMostDamping = 1e6;
constexpr Eigen::Index kMostDenseParameters = 600;

/// Solves the reduced system, of which `normal` holds the lower triangle. Nothing when it is not positive definite. In
/// larger sets most views have no track in common, and the system is treated as the sparse one it is.
std::optional<Eigen::VectorXd> SolveReduced(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right) {
  if (normal.rows() <= kMostDenseParameters) {
    Eigen::MatrixXd factor = normal;
    if (!FactorPositive(factor)) return std::nullopt;
    Eigen::VectorXd solution = right;
    SolveFactored(factor, solution);
    return solution;
  }
  return SolveBanded(normal, right, 6);
}

/// One adjustment: the shares, and the loop that brings them together.
class DistributedAdjustment {
 public:
  DistributedAdjustment(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options,
                        const RunContext& context)
      : state_(state), options_(options), context_(context), layout_(LayOut(state, scope, false)) {
    for (const TrackShare& share : layout_.shares) shares_.emplace_back(state, layout_, share, options);
    poses_.resize(state.poses.size());
    positions_.resize(state.tracks.size());
    costs_.resize(shares_.size());
  }

  Status Run() {
    if (shares_.empty()) return Status::Ok();
    double damping = kFirstDamping;
    for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
      DRUPE_ASSIGN_OR_RETURN(const bool solved, Solve(damping));
      const double before = cost_;
      const double after = solved ? Try(damping) : std::numeric_limits<double>::infinity();
      DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
      if (!std::isfinite(before)) return Internal("adjustment_failed", "bundle adjustment: the cost is not finite");
      if (!(after < before)) {
        damping = std::max(10 * damping, kFirstDamping);
        if (damping > kMostDamping) break;
        continue;
      }
      Accept();
      damping = std::max(kLeastDamping, damping / 5);
      if (before - after <= options_.function_tolerance * before) break;
      if (pose_step_sigmas_ < options_.pose_tolerance_sigmas) break;
    }
    return Status::Ok();
  }

 private:
  /// The shares' equations, their sum and its solution. False when it is not determined under this damping.
  Result<bool> Solve(double damping) {
    std::vector<std::uint8_t> is_ready(shares_.size(), 0);
    DRUPE_RETURN_IF_ERROR(ParallelFor(context_, shares_.size(), [&](std::size_t s) {
      shares_[s].Linearise(damping);
      is_ready[s] = shares_[s].EliminateInner(damping) ? 1 : 0;
    }));
    cost_ = 0;
    for (const ShareElimination& share : shares_) cost_ += share.cost();
    if (std::find(is_ready.begin(), is_ready.end(), 0) != is_ready.end()) return false;
    const Eigen::Index size = 6 * static_cast<Eigen::Index>(layout_.shared_views.size()) + (layout_.moves_ink ? 1 : 0);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size), diagonal = Eigen::VectorXd::Zero(size);
    for (const ShareElimination& share : shares_) share.AddReduced(normal, gradient, diagonal);
    normal.diagonal() += damping * diagonal.cwiseMax(1e-6);
    shared_step_ = gradient;
    if (size > 0) {
      const std::optional<Eigen::VectorXd> step = SolveReduced(normal, -gradient);
      if (!step) return false;
      shared_step_ = *step;
    }
    pose_step_sigmas_ = PoseStepSigmas(gradient);
    return shared_step_.allFinite();
  }

  /// Root mean square of the step of all views' parameters, in units of their standard deviations.
  double PoseStepSigmas(const Eigen::VectorXd& shared_gradient) const {
    double squared = -shared_gradient.dot(shared_step_);
    Eigen::Index parameters = shared_step_.size();
    for (std::size_t s = 0; s < shares_.size(); ++s) {
      squared += shares_[s].inner_decrement();
      parameters += 6 * layout_.shares[s].inner_count;
    }
    return std::sqrt(std::max(0.0, squared) / static_cast<double>(std::max<Eigen::Index>(1, parameters)));
  }

  /// Poses and positions after the step, and their cost.
  double Try(double damping) {
    for (std::size_t v = 0; v < poses_.size(); ++v) {
      if (state_.poses[v]) poses_[v] = *state_.poses[v];
    }
    for (std::size_t s = 0; s < shares_.size(); ++s) {
      shares_[s].SolveInner(shared_step_);
      const std::vector<int>& views = layout_.shares[s].views;
      for (std::size_t k = 0; k < views.size(); ++k) {
        poses_[views[k]] = ApplyStep(*state_.poses[views[k]], shares_[s].StepOf(static_cast<int>(k)));
      }
    }
    ink_spread_mm_ = state_.ink_spread_mm + (layout_.moves_ink ? shared_step_[shared_step_.size() - 1] : 0);
    const Status moved = ParallelFor(context_, shares_.size(), [&](std::size_t s) {
      costs_[s] = shares_[s].MoveTracks(damping, poses_, ink_spread_mm_, positions_);
    });
    double cost = moved.ok() ? 0 : std::numeric_limits<double>::infinity();
    for (const double share_cost : costs_) cost += share_cost;
    return cost;
  }

  void Accept() {
    for (const TrackShare& share : layout_.shares) {
      for (const int t : share.tracks) state_.tracks[t].position = positions_[t];
      for (const int v : share.views) state_.poses[v] = poses_[v];
    }
    state_.ink_spread_mm = ink_spread_mm_;
  }

  SfmState& state_;
  const AdjustmentOptions& options_;
  const RunContext& context_;
  const AdjustmentLayout layout_;
  std::deque<ShareElimination> shares_;
  Eigen::VectorXd shared_step_;
  std::vector<Rigid3> poses_;               ///< per view, after the step
  std::vector<Eigen::Vector3d> positions_;  ///< per track, after the step
  std::vector<double> costs_;               ///< per share, after the step
  double ink_spread_mm_ = 0;
  double cost_ = 0;
  double pose_step_sigmas_ = 0;
};

}  // namespace

Status AdjustDistributed(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options,
                         const RunContext& context) {
  return DistributedAdjustment(state, scope, options, context).Run();
}

}  // namespace drupe
