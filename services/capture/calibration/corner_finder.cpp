#include "capture/calibration/corner_finder.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace drupe {
namespace {

/// The picture's pixels without a copy; OpenCV only reads them.
cv::Mat View(const GrayImage& image) {
  return {image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.Row(0)),
          static_cast<std::size_t>(image.stride())};
}

/// Corners in pixels of `picture`; empty when the pattern is not found. By Duda & Frese, "Accurate detection and
/// localization of checkerboard corners", BMVC 2018, which costs a quarter of a second whether or not there is a
/// pattern; OpenCV's older search takes 5 s to give up on a picture that holds another pattern.
std::vector<cv::Point2f> Search(const cv::Mat& picture, const Checkerboard& pattern) {
  std::vector<cv::Point2f> corners;
  const cv::Size size(pattern.columns, pattern.rows);
  // Threads go over the pictures; OpenCV's own would make the last digits depend on their timing.
  static const bool opencv_is_serial = (cv::setNumThreads(1), true);
  static_cast<void>(opencv_is_serial);
  if (!cv::findChessboardCornersSB(picture, size, corners, cv::CALIB_CB_NORMALIZE_IMAGE)) corners.clear();
  return corners;
}

std::vector<cv::Point2f> SearchReduced(const cv::Mat& picture, const Checkerboard& pattern, int width) {
  if (picture.cols <= width) return Search(picture, pattern);
  const double scale = static_cast<double>(picture.cols) / width;
  cv::Mat reduced;
  cv::resize(picture, reduced, cv::Size(width, std::max(1, cvRound(picture.rows / scale))), 0, 0, cv::INTER_AREA);
  std::vector<cv::Point2f> corners = Search(reduced, pattern);
  for (cv::Point2f& corner : corners) {  // pixel centres are at integers in both
    corner.x = static_cast<float>((corner.x + 0.5) * scale - 0.5);
    corner.y = static_cast<float>((corner.y + 0.5) * picture.rows / reduced.rows - 0.5);
  }
  return corners;
}

/// Distance to the nearest neighbour on the pattern, in pixels.
double SquarePx(const std::vector<cv::Point2f>& corners, const Checkerboard& pattern, int index) {
  const int column = index % pattern.columns, row = index / pattern.columns;
  double nearest = 1e9;
  const auto consider = [&](int other) { nearest = std::min(nearest, cv::norm(corners[index] - corners[other])); };
  if (column > 0) consider(index - 1);
  if (column + 1 < pattern.columns) consider(index + 1);
  if (row > 0) consider(index - pattern.columns);
  if (row + 1 < pattern.rows) consider(index + pattern.columns);
  return nearest;
}

/// Measures every corner in a window that fits its square; leaves out those whose window does not lie in the picture.
PatternCorners Measure(const cv::Mat& picture, const std::vector<cv::Point2f>& found, const Checkerboard& pattern,
                       double window_squares) {
  const cv::TermCriteria criteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 40, 0.001);
  PatternCorners corners;
  for (int i = 0; i < pattern.CornerCount(); ++i) {
    const int half = std::max(2, cvRound(window_squares * SquarePx(found, pattern, i)));
    const cv::Rect2f inside(half + 1.0F, half + 1.0F, picture.cols - 2.0F * half - 3, picture.rows - 2.0F * half - 3);
    if (!inside.contains(found[i])) continue;
    std::vector<cv::Point2f> point{found[i]};
    cv::cornerSubPix(picture, point, cv::Size(half, half), cv::Size(-1, -1), criteria);
    if (cv::norm(point[0] - found[i]) > half) continue;
    corners.indices.push_back(i);
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
    const std::vector<cv::Point2f> found = SearchReduced(picture, pattern, options.search_width_px);
    if (static_cast<int>(found.size()) != pattern.CornerCount()) return PatternCorners{};
    return Measure(picture, found, pattern, options.window_squares);
  } catch (const std::exception& error) {
    return Internal("pattern_search_failed", error.what());
  }
}

}  // namespace drupe
