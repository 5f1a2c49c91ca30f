#include "reconstruction/sparse/monolithic_adjustment.h"

#include <ceres/ceres.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <deque>

#include "reconstruction/sparse/reprojection_cost.h"

namespace drupe {
namespace {

constexpr int kMaxDenseViews = 100;  // beyond, the reduced camera matrix is worth treating as sparse

using PoseBlock = std::array<double, kPoseSize>;
using PoseManifold = ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>;

PoseBlock BlockFromPose(const Rigid3& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  return {q.x(), q.y(), q.z(), q.w(), pose.translation.x(), pose.translation.y(), pose.translation.z()};
}

Rigid3 PoseFromBlock(const PoseBlock& block) {
  Rigid3 pose;
  pose.rotation = Eigen::Quaterniond(block[3], block[0], block[1], block[2]).normalized().toRotationMatrix();
  pose.translation = Eigen::Vector3d(block[4], block[5], block[6]);
  return pose;
}

class StopWhenCancelled final : public ceres::IterationCallback {
 public:
  explicit StopWhenCancelled(const RunContext& context) : context_(context) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return context_.IsCancelled() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const RunContext& context_;
};

ceres::Problem::Options ProblemOptions() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

/// One adjustment: builds the problem, solves it, writes the result back.
class Adjustment {
 public:
  Adjustment(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options)
      : state_(state),
        scope_(scope),
        options_(options),
        feature_loss_(options.feature_loss_px / options.feature_sigma_px),
        board_loss_(options.board_loss_px / options.board_sigma_px),
        intrinsics_{1.0, state.camera.dist[0], state.camera.dist[1]},
        problem_(ProblemOptions()) {
    poses_.resize(state.poses.size());
    is_in_problem_.resize(state.poses.size(), 0);
    for (std::size_t v = 0; v < poses_.size(); ++v) {
      if (state.poses[v]) poses_[v] = BlockFromPose(*state.poses[v]);
    }
  }

  void Build() {
    for (SfmTrack& track : state_.tracks) AddTrack(track);
    if (state_.is_metric) {
      for (int v = 0; v < state_.ViewCount(); ++v) AddBoardCorners(v);
    }
    FixWhatStays();
  }

  Status Solve(const RunContext& context) {
    if (problem_.NumResidualBlocks() == 0) return Status::Ok();
    ceres::Solver::Options options;
    options.linear_solver_type = state_.RegisteredCount() <= kMaxDenseViews ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
    options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>(ordering_);
    options.num_threads = 1;
    options.max_num_iterations = options_.max_iterations;
    options.function_tolerance = options_.function_tolerance;
    options.logging_type = ceres::SILENT;
    StopWhenCancelled stop(context);
    options.callbacks.push_back(&stop);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
    if (!summary.IsSolutionUsable()) return Internal("adjustment_failed", "bundle adjustment: " + summary.message);
    return Status::Ok();
  }

  void WriteBack() {
    for (std::size_t v = 0; v < poses_.size(); ++v) {
      if (is_in_problem_[v]) state_.poses[v] = PoseFromBlock(poses_[v]);
    }
    if (!options_.refine_intrinsics) return;
    state_.camera.fx *= intrinsics_[0], state_.camera.fy *= intrinsics_[0];
    state_.camera.dist[0] = intrinsics_[1], state_.camera.dist[1] = intrinsics_[2];
    Remeasure(state_);
  }

 private:
  bool Moves(int view) const { return scope_.view_moves[view] != 0; }

  double* UsePose(int view) {
    double* block = poses_[view].data();
    if (!is_in_problem_[view]) {
      is_in_problem_[view] = 1;
      problem_.AddParameterBlock(block, kPoseSize, &manifold_);
      ordering_.AddElementToGroup(block, 1);
    }
    return block;
  }

  void AddTrack(SfmTrack& track) {
    if (!track.has_position) return;
    const auto observations = state_.ObservationsOf(track);
    const bool is_touched = std::any_of(observations.begin(), observations.end(),
                                        [this](const SfmObservation& o) { return o.is_active && Moves(o.view); });
    if (!is_touched) return;
    for (const SfmObservation& observation : observations) {
      if (observation.is_active) AddObservation(observation, track.position.data());
    }
    ordering_.AddElementToGroup(track.position.data(), 0);
  }

  void AddObservation(const SfmObservation& observation, double* point) {
    const double sigma = options_.feature_sigma_px * observation.sigma_px;
    double* pose = UsePose(observation.view);
    if (options_.refine_intrinsics) {
      auto cost = MakeRefinedCameraCost(state_.camera, observation.measured.pixel, sigma);
      problem_.AddResidualBlock(cost.release(), &feature_loss_, pose, point, intrinsics_.data());
      return;
    }
    problem_.AddResidualBlock(MakeReprojectionCost(observation.measured, sigma).release(), &feature_loss_, pose, point);
  }

  void AddBoardCorners(int view) {
    if (!state_.poses[view] || !Moves(view)) return;
    for (const BoardCorner& corner : state_.board_corners[view]) {
      double* pose = UsePose(view);
      if (options_.refine_intrinsics) {
        fixed_points_.push_back(corner.planned + state_.ink_spread_mm * corner.outward);
        double* point = fixed_points_.back().data();
        auto cost = MakeRefinedCameraCost(state_.camera, corner.measured.pixel, options_.board_sigma_px);
        problem_.AddResidualBlock(cost.release(), &board_loss_, pose, point, intrinsics_.data());
        problem_.SetParameterBlockConstant(point);
        ordering_.AddElementToGroup(point, 0);
        continue;
      }
      auto cost = MakeBoardCornerCost(corner, options_.board_sigma_px);
      problem_.AddResidualBlock(cost.release(), &board_loss_, pose, &state_.ink_spread_mm);
    }
  }

  void FixWhatStays() {
    bool needs_gauge = !state_.is_metric;
    for (int v = 0; v < state_.ViewCount(); ++v) {
      if (!is_in_problem_[v] || Moves(v)) continue;
      problem_.SetParameterBlockConstant(poses_[v].data());
      needs_gauge = false;
    }
    const auto first = std::find(is_in_problem_.begin(), is_in_problem_.end(), 1);
    if (needs_gauge && first != is_in_problem_.end()) {
      problem_.SetParameterBlockConstant(poses_[first - is_in_problem_.begin()].data());
    }
    for (double* block : {&state_.ink_spread_mm, intrinsics_.data()}) {
      if (problem_.HasParameterBlock(block)) ordering_.AddElementToGroup(block, 1);
    }
  }

  SfmState& state_;
  const AdjustmentScope& scope_;
  const AdjustmentOptions& options_;
  ceres::CauchyLoss feature_loss_, board_loss_;
  PoseManifold manifold_;
  std::vector<PoseBlock> poses_;
  std::vector<std::uint8_t> is_in_problem_;
  std::array<double, kIntrinsicsSize> intrinsics_;
  std::deque<Eigen::Vector3d> fixed_points_;  // a deque: addresses must not move
  ceres::ParameterBlockOrdering ordering_;
  ceres::Problem problem_;
};

}  // namespace

Status AdjustMonolithic(SfmState& state, const AdjustmentScope& scope, const AdjustmentOptions& options,
                        const RunContext& context) {
  try {
    Adjustment adjustment(state, scope, options);
    adjustment.Build();
    DRUPE_RETURN_IF_ERROR(adjustment.Solve(context));
    adjustment.WriteBack();
    return Status::Ok();
  } catch (const std::exception& error) {
    return Internal("adjustment_failed", error.what());
  }
}

}  // namespace drupe
