#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/calibration/coverage.h"

namespace drupe {
namespace {

constexpr int kWidth = 960, kTextBand = 56;
constexpr int kManyCorners = 40;  // in a cell; more make it no greener

cv::Scalar ColourOf(int corners) {
  if (corners == 0) return {150, 150, 240};  // blue, green, red
  const double share = std::sqrt(std::min(corners, kManyCorners) / static_cast<double>(kManyCorners));
  return {235 - 145 * share, 250 - 60 * share, 235 - 145 * share};
}

void DrawCells(const CoverageMap& map, const cv::Size& size, cv::Mat& canvas) {
  for (int row = 0; row < CoverageMap::kRows; ++row) {
    for (int column = 0; column < CoverageMap::kColumns; ++column) {
      const int corners = map.corners[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      const cv::Point from(column * size.width / CoverageMap::kColumns, row * size.height / CoverageMap::kRows);
      const cv::Point to((column + 1) * size.width / CoverageMap::kColumns - 1,
                         (row + 1) * size.height / CoverageMap::kRows - 1);
      cv::rectangle(canvas, from, to, ColourOf(corners), cv::FILLED);
      cv::rectangle(canvas, from, to, cv::Scalar(190, 190, 190));
      cv::putText(canvas, std::to_string(corners), from + cv::Point(5, 15), cv::FONT_HERSHEY_SIMPLEX, 0.4,
                  cv::Scalar(90, 90, 90), 1, cv::LINE_AA);
    }
  }
}

void DrawText(const CoverageMap& map, int top, cv::Mat& canvas) {
  const std::string share = std::to_string(static_cast<int>(std::lround(100 * map.Share())));
  const auto write = [&](const std::string& line, int y) {
    cv::putText(canvas, line, cv::Point(10, top + y), cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(0, 0, 0), 1,
                cv::LINE_AA);
  };
  write(std::to_string(map.pixels.size()) + " corners in " + share + " % of the cells of a picture of " +
            std::to_string(map.width) + " x " + std::to_string(map.height),
        20);
  write("hardly seen: " + map.WeakText(), 42);
}

}  // namespace

Result<std::string> DrawCoverage(const CoverageMap& map) {
  try {
    const double scale = static_cast<double>(kWidth) / std::max(1, map.width);
    const cv::Size size(kWidth, std::clamp(static_cast<int>(map.height * scale), 1, 4 * kWidth));
    cv::Mat canvas(size.height + kTextBand, size.width, CV_8UC3, cv::Scalar(255, 255, 255));
    DrawCells(map, size, canvas);
    for (const Eigen::Vector2d& pixel : map.pixels) {
      const cv::Point2d at((pixel.x() + 0.5) * scale, (pixel.y() + 0.5) * scale);
      cv::circle(canvas, at, 2, cv::Scalar(120, 60, 0), cv::FILLED, cv::LINE_AA);
    }
    DrawText(map, size.height, canvas);
    std::vector<uchar> bytes;
    cv::imencode(".png", canvas, bytes);
    return std::string(bytes.begin(), bytes.end());
  } catch (const std::exception& error) {
    return Internal("drawing_failed", error.what());
  }
}

}  // namespace drupe
