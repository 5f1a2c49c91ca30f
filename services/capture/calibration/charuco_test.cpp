#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "capture/calibration/calibrate.h"
#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

constexpr double kDotsPerMm = 10;

Checkerboard Pattern(bool legacy = false) {
  return {.columns = 8,
          .rows = 5,
          .square_mm = 6,
          .markers = CharucoMarkers{.marker_mm = 4.2, .dictionary = "DICT_4X4_50", .legacy = legacy}};
}

PinholeCamera SharpCamera() {
  return {.width = 800,
          .height = 600,
          .fx = 1100,
          .fy = 1100,
          .cx = 405.2,
          .cy = 296.4,
          .dist = {-0.09, 0.03, 2e-4, -3e-4, 0}};
}

/// The board as printed, at kDotsPerMm; squares of its border included.
cv::Mat Print(const Checkerboard& pattern) {
  const int square = static_cast<int>(pattern.square_mm * kDotsPerMm);
  const int side = static_cast<int>(pattern.markers->marker_mm * kDotsPerMm);
  cv::Mat board((pattern.rows + 1) * square, (pattern.columns + 1) * square, CV_8U, cv::Scalar(255));
  const auto dictionary =
      cv::aruco::getPredefinedDictionary(FindMarkerDictionary(pattern.markers->dictionary)->opencv_id);
  int id = 0;
  for (int row = 0; row <= pattern.rows; ++row) {
    for (int column = 0; column <= pattern.columns; ++column) {
      cv::Mat cell = board(cv::Rect(column * square, row * square, square, square));
      if (!pattern.IsWhite(column, row)) {
        cell.setTo(0);
        continue;
      }
      cv::Mat marker;
      cv::aruco::drawMarker(dictionary, id++, side, marker);
      const int margin = (square - side) / 2;
      marker.copyTo(cell(cv::Rect(margin, margin, side, side)));
    }
  }
  cv::GaussianBlur(board, board, cv::Size(), 2);
  return board;
}

/// A picture of the board tilted about x and y, with its first inner corner moved by `shift` mm from where it would be
/// centred.
std::string Picture(const cv::Mat& board, const Checkerboard& pattern, double tilt_x, double tilt_y,
                    const Eigen::Vector2d& shift) {
  const PinholeCamera camera = SharpCamera();
  const Eigen::Matrix3d r =
      (Eigen::AngleAxisd(tilt_x, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(tilt_y, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  const Eigen::Vector3d middle(pattern.WidthMm() / 2, pattern.HeightMm() / 2, 0);
  const Eigen::Vector3d t = Eigen::Vector3d(shift.x(), shift.y(), 95) - r * middle;
  cv::Mat map_x(camera.height, camera.width, CV_32F), map_y(camera.height, camera.width, CV_32F), picture;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d xy = camera.NormalisedFromPixel({x, y});
      const Eigen::Vector3d ray(xy.x(), xy.y(), 1);
      const Eigen::Vector3d mm = r.transpose() * (r.col(2).dot(t) / r.col(2).dot(ray) * ray - t);
      map_x.at<float>(y, x) = static_cast<float>((mm.x() + pattern.square_mm) * kDotsPerMm - 0.5);
      map_y.at<float>(y, x) = static_cast<float>((mm.y() + pattern.square_mm) * kDotsPerMm - 0.5);
    }
  }
  cv::remap(board, picture, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::GaussianBlur(picture, picture, cv::Size(), 0.7);
  std::vector<uchar> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

std::vector<PatternPicture> Pictures(const Checkerboard& pattern) {
  const cv::Mat board = Print(pattern);
  std::vector<PatternPicture> pictures;
  for (const auto& [tilt_x, tilt_y, x, y] : {std::array{0.5, 0.0, 0.0, 0.0},
                                             {-0.5, 0.1, 14.0, 3.0},
                                             {0.1, 0.55, -16.0, 4.0},
                                             {0.0, -0.55, 12.0, -10.0},
                                             {0.35, -0.3, 4.0, 14.0},
                                             {0.02, 0.0, -8.0, -6.0}}) {
    std::string bytes = Picture(board, pattern, tilt_x, tilt_y, {x, y});
    const std::string name = std::to_string(pictures.size()) + ".png";
    pictures.push_back({name, [bytes = std::move(bytes)]() -> Result<std::string> { return bytes; }});
  }
  return pictures;
}

class CharucoTest : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Layouts, CharucoTest, ::testing::Bool());

TEST_P(CharucoTest, FindsTheTrueCameraThoughTheBoardIsSeenInPart) {
  const Checkerboard pattern = Pattern(GetParam());
  const auto result = RunCalibration(Pictures(pattern), pattern, {}, {});
  ASSERT_TRUE(result.ok()) << result.status().ToString();
  const PinholeCamera found = result->calibration.camera, truth = SharpCamera();
  EXPECT_NEAR(found.fx / truth.fx, 1, 1e-3);
  EXPECT_NEAR(found.cx, truth.cx, 1);
  EXPECT_NEAR(found.cy, truth.cy, 1);
  EXPECT_LT(result->calibration.rms_px, 0.1);
  int partial = 0;
  for (const PictureReport& picture : result->pictures) {
    EXPECT_TRUE(picture.used) << picture.name << picture.reason;
    partial += picture.corners < pattern.CornerCount() ? 1 : 0;
  }
  EXPECT_GT(partial, 0);
}

TEST(CharucoPatternTest, TheOtherLayoutFitsNoPicture) {
  const auto result = RunCalibration(Pictures(Pattern(false)), Pattern(true), {}, {});
  if (!result.ok()) return;  // as good
  EXPECT_GT(result->calibration.rms_px, 2);
  EXPECT_EQ(result->grade, CalibrationGrade::kPoor);
}

TEST(CharucoPatternTest, IsReadAndChecked) {
  const Json json = {{"pattern", "charuco"}, {"inner_corners", {8, 5}},     {"square_mm", 6.0},
                     {"marker_mm", 4.2},     {"dictionary", "DICT_4X4_50"}, {"legacy", true}};
  const auto good = ParseCheckerboard(json);
  ASSERT_TRUE(good.ok()) << good.status().ToString();
  EXPECT_EQ(ToJson(*good), json);
  const auto field_after = [&](const char* key, const Json& value) {
    Json bad = json;
    bad[key] = value;
    const auto pattern = ParseCheckerboard(bad);
    return pattern.ok() ? std::string("ok") : pattern.status().field();
  };
  EXPECT_EQ(field_after("marker_mm", 6), "marker_mm");
  EXPECT_EQ(field_after("marker_mm", "4"), "marker_mm");
  EXPECT_EQ(field_after("dictionary", "DICT_NONE"), "dictionary");
  EXPECT_EQ(field_after("inner_corners", {20, 20}), "dictionary");
  EXPECT_EQ(field_after("legacy", 1), "legacy");
}

TEST(CoverageTest, CountsCornersAndNamesWeakParts) {
  CoverageMap map(800, 600);
  map.Add({{-0.5, -0.5}, {799.4, 599.4}, {50, 50}});
  EXPECT_EQ(map.corners[0][0], 2);
  EXPECT_EQ(map.corners[5][7], 1);
  EXPECT_NEAR(map.Share(), 2.0 / 48, 1e-9);
  EXPECT_EQ(map.WeakParts().size(), 9U);
  for (int y = 0; y < 600; y += 50) {
    for (int x = 0; x < 500; x += 50) map.Add({{x, y}});
  }
  EXPECT_EQ(map.WeakParts(), (std::vector<std::string>{"top right", "right", "bottom right"}));
  EXPECT_EQ(map.WeakText(), "top right, right, bottom right");
  const auto png = DrawCoverage(map);
  ASSERT_TRUE(png.ok());
  const cv::Mat picture = cv::imdecode(std::vector<uchar>(png->begin(), png->end()), cv::IMREAD_COLOR);
  ASSERT_EQ(picture.cols, 960);
  EXPECT_GT(picture.rows, 720);
  const cv::Vec3b empty = picture.at<cv::Vec3b>(200, 890), seen = picture.at<cv::Vec3b>(200, 270);
  EXPECT_GT(empty[2], empty[1]);  // red
  EXPECT_GT(seen[1], seen[2]);    // green
}

}  // namespace
}  // namespace drupe
