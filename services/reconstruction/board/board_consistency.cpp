#include "reconstruction/board/board_consistency.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <vector>

namespace drupe {
namespace {

constexpr double kSigmas = 5.0;
constexpr double kMinTolerancePx = 0.5;
constexpr double kMadToSigma = 1.4826;

struct Correspondences {
  std::vector<cv::Point2d> board;        // mm
  std::vector<cv::Point2d> undistorted;  // normalised coordinates
};

Correspondences Collect(const BoardDetection& markers, const Board& board, const PinholeCamera& camera) {
  Correspondences all;
  for (const MarkerDetection& marker : markers) {
    const auto& corners = board.corners_mm.at(marker.id);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d xy = camera.NormalisedFromPixel(marker.corners_px[k]);
      all.board.emplace_back(corners[k].x(), corners[k].y());
      all.undistorted.emplace_back(xy.x(), xy.y());
    }
  }
  return all;
}

bool IsPlane(const Board& board) {
  const double z = board.corners_mm.begin()->second[0].z();
  for (const auto& [id, corners] : board.corners_mm) {
    for (const Eigen::Vector3d& corner : corners) {
      if (std::abs(corner.z() - z) > 1e-6) return false;
    }
  }
  return true;
}

double LongestSide(const MarkerDetection& marker) {
  double longest = 0;
  for (int k = 0; k < 4; ++k) {
    longest = std::max(longest, (marker.corners_px[(k + 1) % 4] - marker.corners_px[k]).norm());
  }
  return longest;
}

/// Largest distance in pixels of a marker's corners from where the homography puts them.
std::vector<double> MarkerErrors(const Correspondences& all, const cv::Mat& homography, double focal_px) {
  std::vector<cv::Point2d> mapped;
  cv::perspectiveTransform(all.board, mapped, homography);
  std::vector<double> errors(mapped.size() / 4, 0.0);
  for (std::size_t i = 0; i < mapped.size(); ++i) {
    errors[i / 4] = std::max(errors[i / 4], focal_px * cv::norm(mapped[i] - all.undistorted[i]));
  }
  return errors;
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

BoardDetection KeepConsistentMarkers(const BoardDetection& markers, const Board& board, const PinholeCamera& camera,
                                     double max_error_share) {
  if (markers.size() < 3 || !IsPlane(board)) return markers;
  std::vector<double> sides;
  for (const MarkerDetection& marker : markers) sides.push_back(LongestSide(marker));
  const double focal = std::max(camera.fx, camera.fy);
  double tolerance = std::max(kMinTolerancePx, max_error_share * Median(sides));
  BoardDetection kept = markers;
  for (int round = 0; round < 2 && kept.size() >= 3; ++round) {
    const Correspondences all = Collect(kept, board, camera);
    // Threshold in the units of the normalised picture. OpenCV seeds its sampler afresh on every call.
    const cv::Mat homography = cv::findHomography(all.board, all.undistorted, cv::RANSAC, tolerance / focal);
    if (homography.empty()) return {};
    const std::vector<double> errors = MarkerErrors(all, homography, focal);
    BoardDetection next;
    std::vector<double> next_errors;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (errors[i] > tolerance) continue;
      next.push_back(kept[i]);
      next_errors.push_back(errors[i]);
    }
    kept = std::move(next);
    if (kept.empty()) return {};
    tolerance = std::min(tolerance, std::max(kMinTolerancePx, kSigmas * kMadToSigma * Median(next_errors)));
  }
  return kept;
}

}  // namespace drupe
