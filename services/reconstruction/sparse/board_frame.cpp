#include "reconstruction/sparse/board_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/sim3.h"
#include "geometry/solve_symmetric.h"
#include "reconstruction/sparse/pose_estimation.h"

namespace drupe {
namespace {

constexpr double kMaxCornerErrorPx = 3.0;

std::optional<Rigid3> PoseFromCorners(const SfmState& state, int view, const SparseOptions& options,
                                      std::uint64_t seed) {
  const std::vector<BoardCorner>& corners = state.board_corners[view];
  if (static_cast<int>(corners.size()) < options.min_board_corners) return std::nullopt;
  std::vector<PointCorrespondence> correspondences;
  for (const BoardCorner& corner : corners) correspondences.push_back({corner.planned, corner.measured.xy});
  PoseEstimationOptions estimation;
  estimation.max_error = kMaxCornerErrorPx / state.FocalPx();
  estimation.max_iterations = options.max_ransac_iterations;
  estimation.seed = seed + static_cast<std::uint64_t>(view);
  const auto estimate = EstimatePose(correspondences, estimation);
  if (!estimate || estimate->inlier_count < options.min_board_corners) return std::nullopt;
  if (2 * estimate->inlier_count < static_cast<int>(corners.size())) return std::nullopt;
  return estimate->cam_from_world;
}

/// Adds what a corner says about a similarity of the structure (rotation, translation, logarithm of the scale), applied
/// to the camera instead of the world.
void AddCorner(const Rigid3& pose, const BoardCorner& corner, Eigen::Matrix<double, 7, 7>& information) {
  const Eigen::Vector3d p = pose * corner.planned;
  if (p.z() <= 0) return;
  Eigen::Matrix<double, 2, 3> projection;
  projection << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
  const Eigen::Matrix<double, 2, 3> by_point = corner.measured.pixel_from_normalised * projection * pose.rotation;
  Eigen::Matrix<double, 2, 7> jacobian;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector3d row = by_point.row(k);
    jacobian.row(k) << corner.planned.cross(row).transpose(), row.transpose(), row.dot(corner.planned);
  }
  information += jacobian.transpose() * jacobian;
}

}  // namespace

std::vector<std::optional<Rigid3>> BoardPoses(const SfmState& state, const SparseOptions& options, std::uint64_t seed) {
  std::vector<std::optional<Rigid3>> poses(state.ViewCount());
  for (int v = 0; v < state.ViewCount(); ++v) poses[v] = PoseFromCorners(state, v, options, seed);
  return poses;
}

bool AlignToBoard(const std::vector<std::optional<Rigid3>>& board_poses, const SparseOptions& options,
                  SfmState& state) {
  std::vector<Eigen::Vector3d> from, to;
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!state.poses[v] || !board_poses[v]) continue;
    from.push_back(state.poses[v]->Centre());
    to.push_back(board_poses[v]->Centre());
  }
  if (static_cast<int>(from.size()) < std::max(3, options.min_board_views)) return false;
  const Result<Sim3> board_from_model = FitSim3(from, to);
  if (!board_from_model.ok()) return false;
  for (auto& pose : state.poses) {
    if (pose) pose = TransformPose(*pose, *board_from_model);
  }
  for (SfmTrack& track : state.tracks) track.position = *board_from_model * track.position;
  state.is_metric = true;
  return true;
}

double ScaleRelativeSigma(const SfmState& state, double board_sigma_px) {
  Eigen::Matrix<double, 7, 7> information = Eigen::Matrix<double, 7, 7>::Zero();
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!state.poses[v]) continue;
    for (const BoardCorner& corner : state.board_corners[v]) AddCorner(*state.poses[v], corner, information);
  }
  const Eigen::Matrix<double, 7, 1> by_scale = SolveSymmetric<7>(information, Eigen::Matrix<double, 7, 1>::Unit(6));
  return board_sigma_px * std::sqrt(std::max(0.0, by_scale[6]));
}

BoardResidual MeasureBoardResidual(const SfmState& state) {
  BoardResidual residual;
  double sum = 0;
  for (int v = 0; v < state.ViewCount(); ++v) {
    if (!state.poses[v]) continue;
    for (const BoardCorner& corner : state.board_corners[v]) {
      const double error =
          ErrorPx(*state.poses[v], corner.measured, corner.planned + state.ink_spread_mm * corner.outward);
      if (!std::isfinite(error)) continue;
      sum += error * error;
      ++residual.corners;
    }
  }
  if (residual.corners > 0) residual.rms_px = std::sqrt(sum / residual.corners);
  return residual;
}

}  // namespace drupe
