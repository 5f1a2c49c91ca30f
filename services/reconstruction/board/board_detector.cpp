#include "reconstruction/board/board_detector.h"

#include <algorithm>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "reconstruction/board/board_consistency.h"
#include "reconstruction/board/marker_refiner.h"
#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

/// A grey picture reduced by a whole factor, and how its pixels lie in the full one:
/// full = factor * reduced + (factor - 1) / 2.
struct Reduced {
  cv::Mat picture;
  int factor = 1;

  Eigen::Vector2d FullFromReduced(const cv::Point2f& p) const {
    const double shift = 0.5 * (factor - 1);
    return {factor * static_cast<double>(p.x) + shift, factor * static_cast<double>(p.y) + shift};
  }
};

Reduced Reduce(const GrayImage& image, int search_width_px) {
  const cv::Mat full(image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.Row(0)), image.stride());
  Reduced reduced;
  reduced.factor = std::max(1, (image.width() + search_width_px - 1) / search_width_px);
  if (reduced.factor == 1) {
    reduced.picture = full;
    return reduced;
  }
  // Whole blocks only, so that the factor is exact.
  const cv::Size size(image.width() / reduced.factor, image.height() / reduced.factor);
  const cv::Rect blocks(0, 0, size.width * reduced.factor, size.height * reduced.factor);
  cv::resize(full(blocks), reduced.picture, size, 0, 0, cv::INTER_AREA);
  return reduced;
}

/// Markers in the reduced picture, corners to about a pixel. Corners are not refined here: cv::aruco's own refinement
/// is biased on foreshortened markers (OpenCV issue 24113).
void FindMarkers(const cv::Mat& picture, int opencv_dictionary, const BoardDetectorOptions& options,
                 std::vector<std::vector<cv::Point2f>>& corners, std::vector<int>& ids) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(opencv_dictionary);
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  parameters->minMarkerPerimeterRate = 4.0 * options.min_marker_side_px / std::max(picture.cols, picture.rows);
  parameters->adaptiveThreshWinSizeMin = 13;
  parameters->adaptiveThreshWinSizeMax = 33;
  parameters->adaptiveThreshWinSizeStep = 20;
  cv::aruco::detectMarkers(picture, dictionary, corners, ids, parameters);
}

BoardDetection Detect(const GrayImage& image, const Board& board, const MarkerDictionary& dictionary,
                      const BoardDetectorOptions& options) {
  const Reduced reduced = Reduce(image, options.search_width_px);
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  FindMarkers(reduced.picture, dictionary.opencv_id, options, corners, ids);

  PinholeCamera camera;
  camera.fx = camera.fy = std::max(image.width(), image.height());
  if (options.camera) camera = *options.camera;
  const MarkerRefiner refiner(image, camera, dictionary.bits);
  std::map<int, MarkerDetection> by_id;
  std::map<int, int> seen;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!board.corners_mm.contains(ids[i])) continue;
    std::array<Eigen::Vector2d, 4> coarse;
    for (int k = 0; k < 4; ++k) coarse[k] = reduced.FullFromReduced(corners[i][k]);
    const auto refined = refiner.Refine(coarse, 1.5 * reduced.factor);
    if (!refined) continue;
    ++seen[ids[i]];
    by_id[ids[i]] = {ids[i], *refined};
  }
  BoardDetection markers;
  for (const auto& [id, marker] : by_id) {
    if (seen[id] == 1) markers.push_back(marker);  // an id seen twice is false at least once
  }
  return KeepConsistentMarkers(markers, board, camera, options.max_homography_error_share);
}

}  // namespace

Status BoardDetectorOptions::Check() const {
  if (search_width_px < 320 || search_width_px > 16384) {
    return InvalidArgument("invalid_option", "search_width_px must be 320 to 16384", "board.search_width_px");
  }
  if (!(min_marker_side_px >= 8.0 && min_marker_side_px <= 1000.0)) {
    return InvalidArgument("invalid_option", "min_marker_side_px must be 8 to 1000", "board.min_marker_side_px");
  }
  if (!(max_homography_error_share > 0.0 && max_homography_error_share <= 0.5)) {
    return InvalidArgument("invalid_option", "max_homography_error_share must be above 0 and at most 0.5",
                           "board.max_homography_error_share");
  }
  return Status::Ok();
}

Result<BoardDetection> DetectBoard(const GrayImage& image, const Board& board, const BoardDetectorOptions& options) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  if (image.empty() || image.channels() != 1) {
    return InvalidArgument("invalid_image", "the board is searched in a grey picture");
  }
  const MarkerDictionary* dictionary = FindMarkerDictionary(board.dictionary);
  if (dictionary == nullptr) {
    return InvalidArgument("invalid_board", "unknown dictionary " + board.dictionary, "board.dictionary");
  }
  if (board.corners_mm.empty()) return BoardDetection{};
  try {
    return Detect(image, board, *dictionary, options);
  } catch (const std::exception& error) {
    return Internal("board_detection_failed", error.what());
  }
}

}  // namespace drupe
