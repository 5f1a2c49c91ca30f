#include "capture/calibration/corner_finder.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "capture/calibration/charuco_finder.h"

namespace drupe {
namespace {

/// The picture's pixels without a copy; OpenCV only reads them.
cv::Mat View(const GrayImage& image) {
  return {image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.Row(0)),
          static_cast<std::size_t>(image.stride())};
}

/// Corners of a checkerboard; empty when it is not found whole. By Duda & Frese, "Accurate detection and
/// localization of checkerboard corners", BMVC 2018, which costs a quarter of a second whether or not there is a
/// pattern; OpenCV's older search takes 5 s to give up on a picture that holds another pattern.
PatternCorners FindAllCorners(const cv::Mat& picture, const Checkerboard& pattern) {
  std::vector<cv::Point2f> found;
  const cv::Size size(pattern.columns, pattern.rows);
  // Threads go over the pictures; OpenCV's own would make the last digits depend on their timing.
  static const bool opencv_is_serial = (cv::setNumThreads(1), true);
  static_cast<void>(opencv_is_serial);
  if (!cv::findChessboardCornersSB(picture, size, found, cv::CALIB_CB_NORMALIZE_IMAGE)) found.clear();
  PatternCorners corners;
  for (std::size_t i = 0; i < found.size(); ++i) {
    corners.indices.push_back(static_cast<int>(i));
    corners.pixels.emplace_back(found[i].x, found[i].y);
  }
  return corners;
}

/// The corners to a pixel or so, found in a picture reduced to `width`.
PatternCorners SearchReduced(const cv::Mat& picture, const Checkerboard& pattern, int width) {
  cv::Mat reduced = picture;
  if (picture.cols > width) {
    const double scale = static_cast<double>(picture.cols) / width;
    cv::resize(picture, reduced, cv::Size(width, std::max(1, cvRound(picture.rows / scale))), 0, 0, cv::INTER_AREA);
  }
  PatternCorners corners = pattern.markers ? FindCharucoCorners(reduced, pattern) : FindAllCorners(reduced, pattern);
  const double scale_x = static_cast<double>(picture.cols) / reduced.cols;
  const double scale_y = static_cast<double>(picture.rows) / reduced.rows;
  for (Eigen::Vector2d& corner : corners.pixels) {  // pixel centres are at integers in both
    corner = {(corner.x() + 0.5) * scale_x - 0.5, (corner.y() + 0.5) * scale_y - 0.5};
  }
  return corners;
}

/// Pixels of each corner of the pattern; absent where it was not found.
using CornerGrid = std::vector<std::optional<Eigen::Vector2d>>;

CornerGrid GridOf(const PatternCorners& corners, const Checkerboard& pattern) {
  CornerGrid grid(static_cast<std::size_t>(pattern.CornerCount()));
  for (std::size_t i = 0; i < corners.size(); ++i)
    grid[static_cast<std::size_t>(corners.indices[i])] = corners.pixels[i];
  return grid;
}

/// Distance to the nearest neighbour on the pattern, in pixels; 0 without one.
double SquarePx(const CornerGrid& grid, const Checkerboard& pattern, int index) {
  const int column = index % pattern.columns, row = index / pattern.columns;
  double nearest = 0;
  const auto consider = [&](bool exists, int other) {
    if (!exists || !grid[static_cast<std::size_t>(other)]) return;
    const double distance = (*grid[static_cast<std::size_t>(index)] - *grid[static_cast<std::size_t>(other)]).norm();
    nearest = nearest == 0 ? distance : std::min(nearest, distance);
  };
  consider(column > 0, index - 1);
  consider(column + 1 < pattern.columns, index + 1);
  consider(row > 0, index - pattern.columns);
  consider(row + 1 < pattern.rows, index + pattern.columns);
  return nearest;
}

/// Measures every corner in a window that fits its square; leaves out those whose window does not lie in the picture.
PatternCorners Measure(const cv::Mat& picture, const PatternCorners& found, const Checkerboard& pattern,
                       double window_squares) {
  const cv::TermCriteria criteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 0.001);
  const CornerGrid grid = GridOf(found, pattern);
  PatternCorners corners;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const double square_px = SquarePx(grid, pattern, found.indices[i]);
    const int half = std::max(2, cvRound(window_squares * square_px));
    const cv::Point2f start(static_cast<float>(found.pixels[i].x()), static_cast<float>(found.pixels[i].y()));
    const cv::Rect2f inside(half + 1.0F, half + 1.0F, picture.cols - 2.0F * half - 3, picture.rows - 2.0F * half - 3);
    if (square_px == 0 || !inside.contains(start)) continue;
    std::vector<cv::Point2f> point{start};
    cv::cornerSubPix(picture, point, cv::Size(half, half), cv::Size(-1, -1), criteria);
    if (cv::norm(point[0] - start) > half) continue;
    corners.indices.push_back(found.indices[i]);
    corners.pixels.emplace_back(point[0].x, point[0].y);
  }
  return corners;
}

}  // namespace

Status CornerFinderOptions::Check() const {
  if (search_width_px < 200 || search_width_px > 8192) {
    return InvalidArgument("invalid_option", "must be 200 to 8192", "search_width_px");
  }
  if (!(window_squares >= 0.1 && window_squares < 0.5)) {
    return InvalidArgument("invalid_option", "must be at least 0.1 and less than 0.5", "window_squares");
  }
  return Status::Ok();
}

Result<PatternCorners> FindCorners(const GrayImage& image, const Checkerboard& pattern,
                                   const CornerFinderOptions& options) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  try {
    const cv::Mat picture = View(image);
    // Markers are smaller than what tells a checkerboard.
    const int width = pattern.markers ? 2 * options.search_width_px : options.search_width_px;
    const PatternCorners found = SearchReduced(picture, pattern, width);
    return Measure(picture, found, pattern, std::min(options.window_squares, pattern.ClearShare()));
  } catch (const std::exception& error) {
    return Internal("pattern_search_failed", error.what());
  }
}

}  // namespace drupe
