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
