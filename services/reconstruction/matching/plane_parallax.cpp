#include "reconstruction/matching/plane_parallax.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "reconstruction/matching/homography.h"

namespace drupe {
namespace {

constexpr int kInPlane = 5;           ///< points of a sample that make it a plane's
constexpr double kPlaneWidening = 2;  ///< of max_error, for a point of the plane
constexpr int kMaxParallaxSamples = 300;

/// Any five of seven points hold one of these whole.
constexpr int kTriplets[5][3] = {{0, 1, 2}, {3, 4, 5}, {0, 1, 6}, {3, 4, 6}, {2, 5, 6}};

/// The homography of the plane through three of the sample's points that goes with the matrix (Hartley & Zisserman
/// 2004, result 13.6). Nothing when the points do not fix it.
std::optional<Eigen::Matrix3d> PlaneThrough(const Eigen::Matrix3d& f, const Eigen::Vector3d& epipole,
                                            const std::array<PointPair, 7>& sample, const int (&triplet)[3]) {
  const Eigen::Matrix3d a = CrossMatrix(epipole) * f;
  Eigen::Matrix3d points;
  Eigen::Vector3d offsets;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d x = sample[triplet[k]].first.homogeneous(), y = sample[triplet[k]].second.homogeneous();
    const Eigen::Vector3d across = y.cross(epipole);
    points.row(k) = x.transpose();
    offsets[k] = y.cross(a * x).dot(across) / across.squaredNorm();
  }
  if (std::abs(points.determinant()) < 1e-9) return std::nullopt;
  const Eigen::Matrix3d h = a - epipole * (points.inverse() * offsets).transpose();
  if (!h.allFinite()) return std::nullopt;
  return h;
}

/// Candidates for the two pairs off the plane.
std::vector<PointPair> OffPlane(const Eigen::Matrix3d& plane, std::span<const PointPair> pairs, double max_error) {
  std::vector<PointPair> off;
  for (const PointPair& pair : pairs) {
    if (SquaredTransfer(plane, pair) >= max_error * max_error) off.push_back(pair);
  }
  return off;
}

/// Where the plane's picture of a place and its real one differ, they lie on one epipolar line.
Eigen::Vector3d ParallaxLine(const Eigen::Matrix3d& plane, const PointPair& pair) {
  return pair.second.homogeneous().cross(plane * pair.first.homogeneous());
}

}  // namespace

std::optional<Eigen::Matrix3d> PlaneOfSample(const Eigen::Matrix3d& fundamental, const std::array<PointPair, 7>& sample,
                                             double max_error) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(fundamental, Eigen::ComputeFullU);
  const Eigen::Vector3d epipole = svd.matrixU().col(2);
  const double limit = kPlaneWidening * max_error * kPlaneWidening * max_error;
  for (const auto& triplet : kTriplets) {
    const std::optional<Eigen::Matrix3d> plane = PlaneThrough(fundamental, epipole, sample, triplet);
    if (!plane) continue;
    const auto held = std::count_if(sample.begin(), sample.end(),
                                    [&](const PointPair& pair) { return SquaredTransfer(*plane, pair) < limit; });
    if (held >= kInPlane) return plane;
  }
  return std::nullopt;
}

std::optional<Eigen::Matrix3d> CompletePlane(const Eigen::Matrix3d& plane, std::span<const PointPair> pairs,
                                             const RansacOptions& options, std::mt19937_64& random) {
  const double plane_error = kPlaneWidening * options.max_error;
  const Eigen::Matrix3d refined = RefineHomography(plane, pairs, plane_error);
  const std::vector<PointPair> off = OffPlane(refined, pairs, plane_error);
  if (off.size() < 2) return std::nullopt;
  std::optional<Eigen::Matrix3d> best;
  Score least;
  double required = kMaxParallaxSamples;
  for (int iteration = 0; iteration < std::min<double>(required, kMaxParallaxSamples); ++iteration) {
    const auto drawn = DrawDistinct<2>(off.size(), random);
    const Eigen::Vector3d epipole = ParallaxLine(refined, off[drawn[0]]).cross(ParallaxLine(refined, off[drawn[1]]));
    if (!(epipole.norm() > 1e-12)) continue;
    const Eigen::Matrix3d f = (CrossMatrix(epipole.normalized()) * refined).normalized();
    const Score score = ScoreEpipolar(f, off, options.max_error, least.cost);
    if (score.cost >= least.cost) continue;
    least = score;
    best = f;
    required = RequiredIterations(score.inliers, off.size(), 2, options.confidence);
  }
  return best;
}

}  // namespace drupe
