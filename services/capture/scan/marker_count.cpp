#include "capture/scan/marker_count.h"

#include <opencv2/aruco.hpp>
#include <set>
#include <vector>

#include "capture/scan/small_picture.h"
#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

constexpr int kSearchWidth = 1300;  // markers of a board that is of use stay large enough

}  // namespace

int CountMarkers(const GrayImage& image, const std::string& dictionary) {
  const MarkerDictionary* known = FindMarkerDictionary(dictionary);
  if (known == nullptr) return 0;
  GrayImage small = ShrinkTo(image, kSearchWidth);
  const cv::Mat view(small.height(), small.width(), CV_8UC1, small.Row(0), static_cast<std::size_t>(small.stride()));
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  try {
    cv::aruco::detectMarkers(view, cv::aruco::getPredefinedDictionary(known->opencv_id), corners, ids);
  } catch (const cv::Exception&) {
    return 0;
  }
  return static_cast<int>(std::set<int>(ids.begin(), ids.end()).size());
}

}  // namespace drupe
