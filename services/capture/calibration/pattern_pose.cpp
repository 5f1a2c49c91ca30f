#include "capture/calibration/pattern_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <vector>

namespace drupe {
namespace {

constexpr double kDefaultFocal = 1.2;
constexpr double kMinFocal = 0.3, kMaxFocal = 20;
constexpr double kLeastPerspective = 4e-3;  // change of depth across the pattern, squared: less is noise

/// Bounding box of the pattern's outline over the picture's size, the larger side.
double FillOf(const PatternMap& map, const Checkerboard& pattern, int width, int height) {
  const double half_height = pattern.HeightMm() / pattern.WidthMm() / 2;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-half_height, half_height}) {
      const Eigen::Vector2d pixel = (map * Eigen::Vector3d(x, y, 1)).hnormalized();
      low = low.cwiseMin(pixel), high = high.cwiseMax(pixel);
    }
  }
  return std::max(high.x() - low.x(), (high.y() - low.y()) * width / height);
}

}  // namespace

std::optional<PatternMap> MapOf(const PatternCorners& corners, const Checkerboard& pattern, int width, int height) {
  std::vector<cv::Point2d> plane, pixels;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d mm = pattern.CornerMm(corners.indices[i]);
    plane.emplace_back((mm.x() - pattern.WidthMm() / 2) / pattern.WidthMm(),
                       (mm.y() - pattern.HeightMm() / 2) / pattern.WidthMm());
    pixels.emplace_back((corners.pixels[i].x() + 0.5) / width - 0.5,
                        (corners.pixels[i].y() + 0.5 - height / 2.0) / width);
  }
  try {
    const cv::Mat found = plane.size() < 4 ? cv::Mat() : cv::findHomography(plane, pixels);
    if (found.empty() || std::abs(found.at<double>(2, 2)) < 1e-9) return {};
    PatternMap map;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) map(row, column) = found.at<double>(row, column);
    }
    return PatternMap(map / map(2, 2));
  } catch (const std::exception&) {
    return {};
  }
}

double GuessFocal(const std::vector<PatternMap>& maps) {
  double ab = 0, aa = 0;  // least squares of a / f^2 + b = 0
  for (const PatternMap& map : maps) {
    const Eigen::Vector3d u = map.col(0), v = map.col(1);
    const double orthogonal[] = {u.head<2>().dot(v.head<2>()), u.z() * v.z()};
    const double equal[] = {u.head<2>().squaredNorm() - v.head<2>().squaredNorm(), u.z() * u.z() - v.z() * v.z()};
    if (std::max(std::abs(orthogonal[1]), std::abs(equal[1])) < kLeastPerspective) continue;
    ab += orthogonal[0] * orthogonal[1] + equal[0] * equal[1];
    aa += orthogonal[0] * orthogonal[0] + equal[0] * equal[0];
  }
  const double inverse_square = aa > 0 ? -ab / aa : 0;
  const double focal = inverse_square > 0 ? 1 / std::sqrt(inverse_square) : 0;
  return focal > kMinFocal && focal < kMaxFocal ? focal : kDefaultFocal;
}

PatternPose PoseOf(const PatternMap& map, double focal, const Checkerboard& pattern, int width, int height) {
  const Eigen::Vector3d to_ray(1 / focal, 1 / focal, 1);
  const Eigen::Vector3d u = to_ray.asDiagonal() * map.col(0), v = to_ray.asDiagonal() * map.col(1);
  const Eigen::Vector3d middle = to_ray.asDiagonal() * map.col(2);  // depth 1
  const Eigen::Vector3d away = u.cross(v).normalized();             // the normal, pointing away from the camera
  PatternPose pose;
  pose.tilt_deg = std::acos(std::min(1.0, std::abs(away.dot(middle.normalized())))) * 180 / std::numbers::pi;
  // Where the normal that points away leans, the plane comes nearer.
  const Eigen::Vector3d leaning = away - away.dot(middle.normalized()) * middle.normalized();
  if (const double length = leaning.head<2>().norm(); length > 1e-9) {
    pose.nearer_x = leaning.x() / length, pose.nearer_y = leaning.y() / length;
  }
  pose.distance = middle.norm() / std::sqrt(u.norm() * v.norm());
  pose.fill = FillOf(map, pattern, width, height);
  pose.centre_x = map(0, 2) + 0.5;
  pose.centre_y = map(1, 2) * width / height + 0.5;
  return pose;
}

}  // namespace drupe
