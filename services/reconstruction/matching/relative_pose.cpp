#include "reconstruction/matching/relative_pose.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>

#include "geometry/solve_symmetric.h"
#include "reconstruction/matching/five_point.h"
#include "reconstruction/matching/ransac.h"

namespace drupe {
namespace {

constexpr int kSample = 5;
/// Samples at least: a narrow view admits a mirrored pose that explains nearly as much, and the first sample may be
/// its.
constexpr double kMinIterations = 50;
constexpr int kRefineSteps = 5;
/// Points that vote on which of an essential matrix's four poses is the real one.
constexpr std::size_t kMaxVoters = 200;

bool IsInFront(const Rigid3& pose, const PointPair& pair) {
  return DepthsOf(pose, pair).minCoeff() > 0;
}

/// The pose of the four that an essential matrix allows (Hartley & Zisserman 2004, 9.6.2) with most points in front.
Rigid3 PoseFromEssential(const Eigen::Matrix3d& e, std::span<const PointPair> pairs, double max_error) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(e, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU(), v = svd.matrixV();
  if (u.determinant() < 0) u = -u;
  if (v.determinant() < 0) v = -v;
  Eigen::Matrix3d w;
  w << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d turned = u * w * v.transpose(), back = u * w.transpose() * v.transpose();
  const std::array<Rigid3, 4> poses = {{{turned, u.col(2)}, {turned, -u.col(2)}, {back, u.col(2)}, {back, -u.col(2)}}};
  std::array<int, 4> votes{};
  std::size_t voters = 0;
  for (const PointPair& pair : pairs) {
    if (SquaredSampson(e, pair) >= max_error * max_error) continue;
    for (std::size_t i = 0; i < poses.size(); ++i) votes[i] += IsInFront(poses[i], pair) ? 1 : 0;
    if (++voters == kMaxVoters) break;
  }
  return poses[std::max_element(votes.begin(), votes.end()) - votes.begin()];
}

using Tangents = Eigen::Matrix<double, 3, 2>;

/// Two unit vectors across `t` and each other.
Tangents TangentsOf(const Eigen::Vector3d& t) {
  Tangents tangents;
  tangents.col(0) = t.unitOrthogonal();
  tangents.col(1) = t.cross(tangents.col(0)).normalized();
  return tangents;
}

/// The normal equations of one Gauss-Newton step: turn (3), then translation along its tangents (2). The denominator of
/// the Sampson distance counts as constant.
struct NormalEquations {
  Eigen::Matrix<double, 5, 5> jtj = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> jtr = Eigen::Matrix<double, 5, 1>::Zero();

  void Add(const Rigid3& pose, const Eigen::Matrix3d& e, const Tangents& tangents, const PointPair& pair,
           double limit) {
    const Eigen::Vector3d a = pair.first.homogeneous(), b = pair.second.homogeneous();
    const Eigen::Vector3d line = e * a;
    const double norm2 = line.head<2>().squaredNorm() + (e.transpose() * b).head<2>().squaredNorm();
    const double residual = b.dot(line);
    if (!(residual * residual < limit * norm2)) return;
    const Eigen::Vector3d p = pose.rotation * a;
    Eigen::Matrix<double, 5, 1> row;
    row.head<3>() = p.cross(b.cross(pose.translation));
    row.tail<2>() = tangents.transpose() * p.cross(b);
    jtj.noalias() += row * row.transpose() / norm2;
    jtr.noalias() += row * (residual / norm2);
  }
};

Rigid3 Moved(const Rigid3& pose, const Tangents& tangents, const Eigen::Matrix<double, 5, 1>& step) {
  const double angle = step.head<3>().norm();
  Rigid3 moved = pose;
  if (angle > 0) {
    const Eigen::Vector3d axis = step.head<3>() / angle;
    moved.rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix() * pose.rotation;
  }
  moved.translation = (pose.translation + tangents * step.tail<2>()).normalized();
  return moved;
}

/// A locally optimised pose and what it scores.
struct Candidate {
  Rigid3 pose;
  Score score;
};

Candidate Optimise(const Eigen::Matrix3d& e, std::span<const PointPair> pairs, double max_error) {
  Candidate candidate;
  candidate.pose = RefineRelativePose(pairs, max_error, PoseFromEssential(e, pairs, max_error));
  candidate.score =
      ScoreEpipolar(EssentialFromPose(candidate.pose), pairs, max_error, std::numeric_limits<double>::infinity());
  return candidate;
}

}  // namespace

Rigid3 RefineRelativePose(std::span<const PointPair> pairs, double max_error, const Rigid3& start) {
  Rigid3 pose = start;
  for (int i = 0; i < kRefineSteps; ++i) {
    const Eigen::Matrix3d e = EssentialFromPose(pose);
    const Tangents tangents = TangentsOf(pose.translation);
    NormalEquations equations;
    for (const PointPair& pair : pairs) equations.Add(pose, e, tangents, pair, max_error * max_error);
    const Eigen::Matrix<double, 5, 1> step = -SolveSymmetric(equations.jtj, equations.jtr);
    if (!step.allFinite() || step.cwiseAbs().maxCoeff() > 0.5) break;
    pose = Moved(pose, tangents, step);
    if (step.cwiseAbs().maxCoeff() < 1e-10) break;
  }
  return pose;
}

std::vector<int> InliersOf(const Rigid3& second_from_first, std::span<const PointPair> pairs, double max_error) {
  const Eigen::Matrix3d e = EssentialFromPose(second_from_first);
  std::vector<int> inliers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (SquaredSampson(e, pairs[i]) < max_error * max_error && IsInFront(second_from_first, pairs[i])) {
      inliers.push_back(static_cast<int>(i));
    }
  }
  return inliers;
}

std::optional<RelativePose> EstimateRelativePose(std::span<const PointPair> pairs, const RansacOptions& options) {
  if (pairs.size() < kSample) return std::nullopt;
  std::mt19937_64 random(options.seed);
  Candidate best;
  const double most = std::max(kMinIterations, MostIterations(pairs.size(), kSample, options));
  double required = most;
  for (int iteration = 0; iteration < std::min(required, most); ++iteration) {
    std::array<PointPair, kSample> sample;
    const auto drawn = DrawDistinct<kSample>(pairs.size(), random);
    for (int i = 0; i < kSample; ++i) sample[i] = pairs[drawn[i]];
    for (const Eigen::Matrix3d& e : SolveFivePoint(sample)) {
      if (ScoreEpipolar(e, pairs, options.max_error, best.score.cost).cost >= best.score.cost) continue;
      const Candidate candidate = Optimise(e, pairs, options.max_error);
      if (candidate.score.cost >= best.score.cost) continue;
      best = candidate;
      required =
          std::max(kMinIterations, RequiredIterations(best.score.inliers, pairs.size(), kSample, options.confidence));
    }
  }
  if (best.score.inliers == 0) return std::nullopt;
  // The distances alone do not feel which side of the cameras a point is on, so the refinement may have changed sides.
  best.pose = PoseFromEssential(EssentialFromPose(best.pose), pairs, options.max_error);
  best.pose = RefineRelativePose(pairs, options.max_error, best.pose);
  return RelativePose{best.pose, InliersOf(best.pose, pairs, options.max_error)};
}

}  // namespace drupe
