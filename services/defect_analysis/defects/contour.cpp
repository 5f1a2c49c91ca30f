#include "defect_analysis/defects/contour.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace drupe {

double SignedArea(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum / 2;
}

Eigen::Vector2d Centroid(const Polygon& polygon) {
  const Eigen::Vector2d origin = polygon.front();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - origin;
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - origin;
    const double cross = a.x() * b.y() - a.y() * b.x();
    sum += cross * (a + b) / 3;
    area += cross;
  }
  return area == 0 ? origin : Eigen::Vector2d(origin + sum / area);
}

bool Contains(const Polygon& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

double CommonArea(const Polygon& a, const Polygon& b) {
  constexpr int kSamples = 100;
  const Polygon& smaller = SignedArea(a) < SignedArea(b) ? a : b;
  const Polygon& larger = SignedArea(a) < SignedArea(b) ? b : a;
  if (smaller.empty()) return 0;
  Eigen::Vector2d low = smaller[0], high = smaller[0];
  for (const Eigen::Vector2d& p : smaller) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Eigen::Vector2d step = (high - low) / kSamples;
  int common = 0;
  for (int k = 0; k < kSamples * kSamples; ++k) {
    const Eigen::Vector2d p = low + step.cwiseProduct(Eigen::Vector2d(k % kSamples + 0.5, k / kSamples + 0.5));
    common += Contains(smaller, p) && Contains(larger, p) ? 1 : 0;
  }
  return common * step.prod();
}

double ClosedLength(const std::vector<Eigen::Vector3d>& points) {
  double length = 0;
  for (std::size_t i = 0; i < points.size(); ++i) length += (points[(i + 1) % points.size()] - points[i]).norm();
  return length;
}

double HeronArea(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& normal) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) middle += p / static_cast<double>(points.size());
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d a = points[i] - middle;
    const Eigen::Vector3d b = points[(i + 1) % points.size()] - middle;
    const double x = a.norm(), y = b.norm(), z = (b - a).norm(), s = (x + y + z) / 2;
    const double triangle = std::sqrt(std::max(0.0, s * (s - x) * (s - y) * (s - z)));
    area += a.cross(b).dot(normal) < 0 ? -triangle : triangle;
  }
  return std::abs(area);
}

}  // namespace drupe
