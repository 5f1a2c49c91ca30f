#include "geometry/p3p.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "geometry/small_eigen.h"

namespace drupe {
namespace {

constexpr double kLeastLeading = 1e-12;  ///< of the quartic
constexpr double kRootTolerance = 1e-4;  ///< of RealRoots: half the digits of a double root are lost

/// The triangle of the points and the angles between the rays, in Haralick's letters: a, b, c are the sides opposite
/// the points 1, 2, 3, squared; alpha, beta, gamma the angles between rays 2-3, 1-3, 1-2.
struct Triangle {
  double a2, b2, c2;
  double cos_alpha, cos_beta, cos_gamma;
};

/// Coefficients of the quartic in v = s3 / s1, constant first.
std::array<double, 5> Quartic(const Triangle& t) {
  const double p = (t.a2 - t.c2) / t.b2, q = (t.a2 + t.c2) / t.b2;
  const double c_b = t.c2 / t.b2, a_b = t.a2 / t.b2;
  const double ca = t.cos_alpha, cb = t.cos_beta, cg = t.cos_gamma;
  return {
      (1 + p) * (1 + p) - 4 * a_b * cg * cg, 4 * (-p * (1 + p) * cb + 2 * a_b * cg * cg * cb - (1 - q) * ca * cg),
      2 * (p * p - 1 + 2 * p * p * cb * cb + 2 * (1 - c_b) * ca * ca - 4 * q * ca * cb * cg + 2 * (1 - a_b) * cg * cg),
      4 * (p * (1 - p) * cb - (1 - q) * ca * cg + 2 * c_b * ca * ca * cb), (p - 1) * (p - 1) - 4 * c_b * ca * ca};
}

/// Newton's method on the three cosine laws; also repairs double roots, which eigenvalues give to half the digits.
void PolishDistances(const Triangle& t, Eigen::Vector3d& s) {
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d error(s[1] * s[1] + s[2] * s[2] - 2 * s[1] * s[2] * t.cos_alpha - t.a2,
                                s[0] * s[0] + s[2] * s[2] - 2 * s[0] * s[2] * t.cos_beta - t.b2,
                                s[0] * s[0] + s[1] * s[1] - 2 * s[0] * s[1] * t.cos_gamma - t.c2);
    Eigen::Matrix3d jacobian;
    jacobian << 0, 2 * (s[1] - s[2] * t.cos_alpha), 2 * (s[2] - s[1] * t.cos_alpha),  //
        2 * (s[0] - s[2] * t.cos_beta), 0, 2 * (s[2] - s[0] * t.cos_beta),            //
        2 * (s[0] - s[1] * t.cos_gamma), 2 * (s[1] - s[0] * t.cos_gamma), 0;
    if (std::abs(jacobian.determinant()) < 1e-30) return;
    s -= jacobian.inverse() * error;
  }
}

/// Axes of a triangle: first along side 1-2, third its normal.
Eigen::Matrix3d TriangleAxes(const Eigen::Vector3d& p1, const Eigen::Vector3d& p2, const Eigen::Vector3d& p3) {
  Eigen::Matrix3d axes;
  axes.col(0) = (p2 - p1).normalized();
  axes.col(2) = axes.col(0).cross(p3 - p1).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

}  // namespace

std::vector<Rigid3> SolveP3p(const std::array<Eigen::Vector3d, 3>& points, const std::array<Eigen::Vector2d, 3>& rays) {
  std::array<Eigen::Vector3d, 3> j;
  for (int i = 0; i < 3; ++i) j[i] = rays[i].homogeneous().normalized();
  const Triangle t{(points[1] - points[2]).squaredNorm(),
                   (points[0] - points[2]).squaredNorm(),
                   (points[0] - points[1]).squaredNorm(),
                   j[1].dot(j[2]),
                   j[0].dot(j[2]),
                   j[0].dot(j[1])};
  const double area2 = (points[1] - points[0]).cross(points[2] - points[0]).squaredNorm();
  if (area2 < 1e-12 * t.b2 * t.c2 || t.b2 <= 0) return {};

  const double p = (t.a2 - t.c2) / t.b2;
  const std::array<double, 5> quartic = Quartic(t);
  if (std::abs(quartic[4]) < kLeastLeading) return {};
  std::vector<Rigid3> poses;
  for (const double v : RealRoots(quartic, kRootTolerance)) {
    const double denominator = 2 * (t.cos_gamma - v * t.cos_alpha);
    if (v <= 0 || std::abs(denominator) < 1e-12) continue;
    const double u = ((p - 1) * v * v - 2 * p * t.cos_beta * v + 1 + p) / denominator;
    const double s1_squared = t.b2 / (1 + v * v - 2 * v * t.cos_beta);
    if (u <= 0 || !(s1_squared > 0)) continue;
    Eigen::Vector3d s = std::sqrt(s1_squared) * Eigen::Vector3d(1, u, v);
    PolishDistances(t, s);
    if (!s.allFinite() || s.minCoeff() <= 0) continue;
    Rigid3 pose;
    pose.rotation =
        TriangleAxes(s[0] * j[0], s[1] * j[1], s[2] * j[2]) * TriangleAxes(points[0], points[1], points[2]).transpose();
    pose.translation = s[0] * j[0] - pose.rotation * points[0];
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace drupe
