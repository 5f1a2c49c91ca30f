#include "reconstruction/matching/fundamental.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/solve_symmetric.h"
#include "reconstruction/matching/plane_parallax.h"
#include "reconstruction/matching/seven_point.h"

namespace drupe {
namespace {

constexpr int kSevenPoints = 7;
constexpr int kFundamentalSteps = 12;
constexpr double kFirstDamping = 1e-6;  ///< relative to the mean of the diagonal
constexpr double kConverged = 1e-9;     ///< relative decrease of the cost at which to stop
constexpr double kFundamentalIterations = 50;

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// F = u diag(cos, sin, 0) v^T with rotations u and v: seven parameters, and rank 2 whatever they are.
struct Orthonormal {
  Eigen::Matrix3d u, v;
  double angle = 0;

  explicit Orthonormal(const Eigen::Matrix3d& f) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    u = svd.matrixU();
    v = svd.matrixV();
    if (u.determinant() < 0) u = -u;
    if (v.determinant() < 0) v = -v;
    angle = std::atan2(svd.singularValues()[1], svd.singularValues()[0]);
  }
  Eigen::Vector3d Diagonal() const { return {std::cos(angle), std::sin(angle), 0}; }
  Eigen::Matrix3d Matrix() const { return u * Diagonal().asDiagonal() * v.transpose(); }
};

Eigen::Matrix3d Turned(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& by) {
  const double angle = by.norm();
  if (angle == 0) return rotation;
  return rotation * Eigen::AngleAxisd(angle, by / angle).toRotationMatrix();
}

/// The normal equations of one Gauss-Newton step: turns of u and v, then the angle. The denominator of the Sampson
/// distance counts as constant.
struct FundamentalEquations {
  Matrix7d jtj = Matrix7d::Zero();
  Vector7d jtr = Vector7d::Zero();

  void Add(const Orthonormal& at, const Eigen::Matrix3d& f, const PointPair& pair, double limit) {
    const Eigen::Vector3d a = pair.first.homogeneous(), b = pair.second.homogeneous();
    const Eigen::Vector3d line = f * a;
    const double norm2 = line.head<2>().squaredNorm() + (f.transpose() * b).head<2>().squaredNorm();
    const double residual = b.dot(line);
    if (!(residual * residual < limit * norm2)) return;
    const Eigen::Vector3d alpha = at.v.transpose() * a, beta = at.u.transpose() * b;
    const Eigen::Vector3d diagonal = at.Diagonal();
    Vector7d row;
    row.head<3>() = diagonal.cwiseProduct(alpha).cross(beta);
    row.segment<3>(3) = diagonal.cwiseProduct(beta).cross(alpha);
    row[6] = diagonal[0] * beta[1] * alpha[1] - diagonal[1] * beta[0] * alpha[0];
    jtj.noalias() += row * row.transpose() / norm2;
    jtr.noalias() += row * (residual / norm2);
  }
};

/// Where a damped step leads. Damped, because a matrix of two equal singular values leaves one of the parameters open.
Orthonormal Stepped(const Orthonormal& at, std::span<const PointPair> pairs, double max_error, double damping) {
  const Eigen::Matrix3d f = at.Matrix();
  FundamentalEquations equations;
  for (const PointPair& pair : pairs) equations.Add(at, f, pair, max_error * max_error);
  equations.jtj.diagonal().array() += damping * equations.jtj.diagonal().mean();
  const Vector7d step = -SolveSymmetric(equations.jtj, equations.jtr);
  if (!step.allFinite()) return at;
  Orthonormal next = at;
  next.u = Turned(at.u, step.head<3>());
  next.v = Turned(at.v, step.segment<3>(3));
  next.angle += step[6];
  return next;
}

double CostOf(const Eigen::Matrix3d& f, std::span<const PointPair> pairs, double max_error) {
  return ScoreEpipolar(f, pairs, max_error, std::numeric_limits<double>::infinity()).cost;
}

/// The search for one pair of pictures.
class FundamentalSearch {
 public:
  FundamentalSearch(std::span<const PointPair> pairs, const RansacOptions& options)
      : pairs_(pairs), options_(options), random_(options.seed) {}

  std::optional<FundamentalEstimate> Run() {
    const double most = std::max(kFundamentalIterations, MostIterations(pairs_.size(), kSevenPoints, options_));
    double required = most;
    for (int iteration = 0; iteration < std::min(required, most); ++iteration) {
      const std::array<PointPair, kSevenPoints> sample = Draw();
      bool improved = false;
      for (const Eigen::Matrix3d& f : SolveSevenPoint(sample)) improved = Consider(f, sample) || improved;
      if (!improved) continue;
      required = std::max(kFundamentalIterations,
                          RequiredIterations(score_.inliers, pairs_.size(), kSevenPoints, options_.confidence));
    }
    if (score_.inliers < kSevenPoints) return std::nullopt;
    best_.inliers = InliersOf(best_.matrix, pairs_, options_.max_error);
    return best_;
  }

 private:
  std::array<PointPair, kSevenPoints> Draw() {
    const auto drawn = DrawDistinct<kSevenPoints>(pairs_.size(), random_);
    std::array<PointPair, kSevenPoints> sample;
    for (int i = 0; i < kSevenPoints; ++i) sample[i] = pairs_[drawn[i]];
    return sample;
  }

  /// True when the sample's matrix, or what its plane is completed to, is the best so far.
  bool Consider(const Eigen::Matrix3d& f, const std::array<PointPair, kSevenPoints>& sample) {
    if (ScoreEpipolar(f, pairs_, options_.max_error, score_.cost).cost >= score_.cost) return false;
    const bool improved = Keep(f, false);
    const std::optional<Eigen::Matrix3d> plane = PlaneOfSample(f, sample, options_.max_error);
    if (!plane) return improved;
    const std::optional<Eigen::Matrix3d> completed = CompletePlane(*plane, pairs_, options_, random_);
    return (completed && Keep(*completed, true)) || improved;
  }

  /// Optimises a matrix locally and keeps it when it is the best.
  bool Keep(const Eigen::Matrix3d& f, bool from_plane) {
    const Eigen::Matrix3d refined = RefineFundamental(pairs_, options_.max_error, f);
    const Score score = ScoreEpipolar(refined, pairs_, options_.max_error, std::numeric_limits<double>::infinity());
    if (!(score.cost < score_.cost)) return false;
    score_ = score;
    best_.matrix = refined;
    best_.from_plane = from_plane;
    return true;
  }

  std::span<const PointPair> pairs_;
  const RansacOptions& options_;
  std::mt19937_64 random_;
  FundamentalEstimate best_;
  Score score_;
};

}  // namespace

Eigen::Matrix3d RefineFundamental(std::span<const PointPair> pairs, double max_error, const Eigen::Matrix3d& start) {
  Orthonormal at(start);
  double cost = CostOf(at.Matrix(), pairs, max_error);
  double damping = kFirstDamping;
  for (int i = 0; i < kFundamentalSteps; ++i) {
    const Orthonormal next = Stepped(at, pairs, max_error, damping);
    const double next_cost = CostOf(next.Matrix(), pairs, max_error);
    if (!(next_cost < cost)) {
      damping *= 100;
      continue;
    }
    const bool converged = cost - next_cost <= kConverged * cost;
    at = next;
    cost = next_cost;
    damping *= 0.1;
    if (converged) break;
  }
  return at.Matrix();
}

std::vector<int> InliersOf(const Eigen::Matrix3d& fundamental, std::span<const PointPair> pairs, double max_error) {
  std::vector<int> inliers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (SquaredSampson(fundamental, pairs[i]) < max_error * max_error) inliers.push_back(static_cast<int>(i));
  }
  return inliers;
}

std::optional<FundamentalEstimate> EstimateFundamental(std::span<const PointPair> pairs, const RansacOptions& options) {
  if (pairs.size() < kSevenPoints) return std::nullopt;
  return FundamentalSearch(pairs, options).Run();
}

}  // namespace drupe
