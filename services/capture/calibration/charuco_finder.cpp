#include "capture/calibration/charuco_finder.h"

#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <set>
#include <utility>
#include <vector>

#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

constexpr double kNearSquares = 1.6;  // markers whose middle is this near a corner place it
constexpr std::size_t kMinLines = 3;  // rows, and columns, that corners must be seen of

/// A marker of the board in the picture.
struct SeenMarker {
  cv::Point2f middle;                ///< on the board, in squares from the first inner corner
  std::vector<cv::Point2f> squares;  ///< its corners there, clockwise from the top left
  std::vector<cv::Point2f> pixels;
};

/// The board's middles of markers by id.
std::map<int, cv::Point2f> MiddlesOf(const Checkerboard& pattern) {
  std::map<int, cv::Point2f> middles;
  int id = 0;
  for (int row = 0; row <= pattern.rows; ++row) {
    for (int column = 0; column <= pattern.columns; ++column) {
      if (!pattern.IsWhite(column, row)) continue;
      middles[id++] = {static_cast<float>(column) - 0.5F, static_cast<float>(row) - 0.5F};
    }
  }
  return middles;
}

std::vector<SeenMarker> DetectMarkers(const cv::Mat& picture, const Checkerboard& pattern) {
  const MarkerDictionary* dictionary = FindMarkerDictionary(pattern.markers->dictionary);
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(picture, cv::aruco::getPredefinedDictionary(dictionary->opencv_id), corners, ids);
  const std::map<int, cv::Point2f> middles = MiddlesOf(pattern);
  const float half = static_cast<float>(pattern.markers->marker_mm / pattern.square_mm / 2);
  std::vector<SeenMarker> seen;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto place = middles.find(ids[i]);
    if (place == middles.end()) continue;
    const auto [x, y] = place->second;
    seen.push_back({place->second,
                    {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}},
                    corners[i]});
  }
  return seen;
}

/// The pixel of the board's point `at` (in squares), if a marker touches it.
std::optional<cv::Point2f> Place(const cv::Point2f& at, const std::vector<SeenMarker>& seen) {
  std::vector<cv::Point2f> squares, pixels;
  bool touches = false;
  for (const SeenMarker& marker : seen) {
    const double distance = cv::norm(marker.middle - at);
    if (distance > kNearSquares) continue;
    touches = touches || distance < 1;
    squares.insert(squares.end(), marker.squares.begin(), marker.squares.end());
    pixels.insert(pixels.end(), marker.pixels.begin(), marker.pixels.end());
  }
  if (!touches) return {};
  const cv::Mat map = cv::findHomography(squares, pixels);
  if (map.empty()) return {};
  std::vector<cv::Point2f> placed;
  cv::perspectiveTransform(std::vector<cv::Point2f>{at}, placed, map);
  return placed[0];
}

}  // namespace

PatternCorners FindCharucoCorners(const cv::Mat& picture, const Checkerboard& pattern) {
  const std::vector<SeenMarker> seen = DetectMarkers(picture, pattern);
  PatternCorners corners;
  std::set<int> columns, rows;
  for (int i = 0; i < pattern.CornerCount(); ++i) {
    const int column = i % pattern.columns, row = i / pattern.columns;
    const auto pixel = Place(cv::Point2f(static_cast<float>(column), static_cast<float>(row)), seen);
    if (!pixel) continue;
    corners.indices.push_back(i);
    corners.pixels.emplace_back(pixel->x, pixel->y);
    columns.insert(column), rows.insert(row);
  }
  return columns.size() < kMinLines || rows.size() < kMinLines ? PatternCorners{} : corners;
}

}  // namespace drupe
