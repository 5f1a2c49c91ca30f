#include "reconstruction/board/board_detector.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/aruco.hpp>
#include <random>
#include <vector>

#include "geometry/rigid3.h"

namespace drupe {
namespace {

constexpr int kColumns = 5, kRows = 4;
constexpr double kMarkerMm = 8.0, kPitchMm = 12.0;

/// The default layout, smaller: ids row by row, z = 0, y up.
Board SmallBoard() {
  Board board;
  for (int id = 0; id < kColumns * kRows; ++id) {
    const double left = (id % kColumns) * kPitchMm - 0.5 * (kColumns * kPitchMm - 4.0);
    const double top = 0.5 * (kRows * kPitchMm - 4.0) - (id / kColumns) * kPitchMm;
    board.corners_mm[id] = {Eigen::Vector3d(left, top, 0), Eigen::Vector3d(left + kMarkerMm, top, 0),
                            Eigen::Vector3d(left + kMarkerMm, top - kMarkerMm, 0),
                            Eigen::Vector3d(left, top - kMarkerMm, 0)};
  }
  return board;
}

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.width = 960, camera.height = 640;
  camera.fx = camera.fy = 1400, camera.cx = 471.3, camera.cy = 325.8;
  camera.dist = {-0.08, 0.02, 0.0004, -0.0003, 0};
  return camera;
}

/// Looks down on the board at about 35 degrees from its plane, as the turntable's camera does.
Rigid3 TestPose() {
  Rigid3 pose;
  pose.rotation =
      (Eigen::AngleAxisd(-M_PI + 0.95, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  pose.translation = Eigen::Vector3d(1.0, -2.0, 115.0);
  return pose;
}

/// Paper grey or black at a point of the board's plane; ids may be replaced to print a wrong marker.
class Print {
 public:
  explicit Print(const std::vector<int>& ids) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_250);
    for (int id : ids) {
      cv::Mat bits;
      cv::aruco::drawMarker(dictionary, id, 6, bits, 1);
      markers_.push_back(bits);
    }
  }

  double At(double x, double y) const {
    const double u = x + 0.5 * (kColumns * kPitchMm - 4.0), v = 0.5 * (kRows * kPitchMm - 4.0) - y;
    if (u < 0 || v < 0) return 210;
    const int column = static_cast<int>(u / kPitchMm), row = static_cast<int>(v / kPitchMm);
    const double in_u = u - column * kPitchMm, in_v = v - row * kPitchMm;
    if (column >= kColumns || row >= kRows || in_u >= kMarkerMm || in_v >= kMarkerMm) return 210;
    const int i = static_cast<int>(in_u / kMarkerMm * 6), j = static_cast<int>(in_v / kMarkerMm * 6);
    return markers_[row * kColumns + column].at<std::uint8_t>(j, i) ? 210 : 25;
  }

 private:
  std::vector<cv::Mat> markers_;
};

using Occluder = std::function<bool(double x, double y)>;

/// Ray traced with 4 x 4 samples a pixel and noise of 2 grey levels. Where the occluder says so, mid grey.
GrayImage Render(const Print& print, const PinholeCamera& camera, const Rigid3& pose, const Occluder& hidden = {}) {
  GrayImage image(camera.width, camera.height);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 2);
  const Rigid3 board_from_cam = pose.Inverse();
  const auto sample = [&](double px, double py) {
    const Eigen::Vector2d xy = camera.NormalisedFromPixel({px, py});
    const Eigen::Vector3d ray = board_from_cam.rotation * Eigen::Vector3d(xy.x(), xy.y(), 1);
    const Eigen::Vector3d hit = board_from_cam.translation - ray * (board_from_cam.translation.z() / ray.z());
    return hidden && hidden(hit.x(), hit.y()) ? 120.0 : print.At(hit.x(), hit.y());
  };
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      double sum = 0;
      for (int k = 0; k < 16; ++k) sum += sample(x - 0.375 + 0.25 * (k % 4), y - 0.375 + 0.25 * (k / 4));
      image.At(x, y) = static_cast<std::uint8_t>(std::clamp(sum / 16 + noise(random), 0.0, 255.0));
    }
  }
  return image;
}

std::vector<int> InOrder() {
  std::vector<int> ids(kColumns * kRows);
  for (int i = 0; i < kColumns * kRows; ++i) ids[i] = i;
  return ids;
}

struct Errors {
  double rms = 0, max = 0;
};

Errors CompareWithTruth(const BoardDetection& found, const Board& board, const PinholeCamera& camera) {
  Errors errors;
  for (const MarkerDetection& marker : found) {
    for (int k = 0; k < 4; ++k) {
      const double e = (marker.corners_px[k] - *camera.Project(TestPose() * board.corners_mm.at(marker.id)[k])).norm();
      errors.rms += e * e, errors.max = std::max(errors.max, e);
    }
  }
  errors.rms = std::sqrt(errors.rms / std::max<std::size_t>(1, 4 * found.size()));
  return errors;
}

bool Contains(const BoardDetection& found, int id) {
  return std::any_of(found.begin(), found.end(), [id](const MarkerDetection& marker) { return marker.id == id; });
}

TEST(BoardDetectorTest, NominalCornersAreWithinATenthOfAPixel) {
  const Board board = SmallBoard();
  BoardDetectorOptions options;
  options.camera = TestCamera();
  const auto found = DetectBoard(Render(Print(InOrder()), TestCamera(), TestPose()), board, options);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->size(), 20u);
  const Errors errors = CompareWithTruth(*found, board, TestCamera());
  EXPECT_LT(errors.rms, 0.05);
  EXPECT_LT(errors.max, 0.15);
}

TEST(BoardDetectorTest, SearchInAReducedPictureMeasuresInTheFullOne) {
  const Board board = SmallBoard();
  BoardDetectorOptions options;
  options.camera = TestCamera();
  options.search_width_px = 480;
  const auto found = DetectBoard(Render(Print(InOrder()), TestCamera(), TestPose()), board, options);
  ASSERT_TRUE(found.ok());
  EXPECT_GE(found->size(), 16u);
  EXPECT_LT(CompareWithTruth(*found, board, TestCamera()).rms, 0.05);
}

TEST(BoardDetectorTest, MarkerInTheWrongPlaceIsDropped) {
  std::vector<int> ids = InOrder();
  std::swap(ids[7], ids[12]);
  ids[3] = 200;  // not of this board
  const auto found = DetectBoard(Render(Print(ids), TestCamera(), TestPose()), SmallBoard());
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->size(), 17u);
  for (int id : {3, 7, 12, 200}) EXPECT_FALSE(Contains(*found, id)) << id;
}

TEST(BoardDetectorTest, IdPrintedTwiceIsDropped) {
  std::vector<int> ids = InOrder();
  ids[19] = 0;
  const auto found = DetectBoard(Render(Print(ids), TestCamera(), TestPose()), SmallBoard());
  ASSERT_TRUE(found.ok());
  EXPECT_FALSE(Contains(*found, 0));
  EXPECT_EQ(found->size(), 18u);
}

TEST(BoardDetectorTest, MarkersBehindTheFruitAreLeftOut) {
  const Board board = SmallBoard();
  BoardDetectorOptions options;
  options.camera = TestCamera();
  const auto disc = [](double x, double y) { return x * x + y * y < 14.5 * 14.5; };
  const auto found = DetectBoard(Render(Print(InOrder()), TestCamera(), TestPose(), disc), board, options);
  ASSERT_TRUE(found.ok());
  EXPECT_GE(found->size(), 8u);
  EXPECT_FALSE(Contains(*found, 7));
  EXPECT_LT(CompareWithTruth(*found, board, TestCamera()).max, 0.2);
}

TEST(BoardDetectorTest, EmptyPictureHasNoMarkers) {
  GrayImage image(640, 480);
  for (int y = 0; y < 480; ++y) std::fill_n(image.Row(y), 640, std::uint8_t{90});
  const auto found = DetectBoard(image, SmallBoard());
  ASSERT_TRUE(found.ok());
  EXPECT_TRUE(found->empty());
}

TEST(BoardDetectorTest, RefusesWhatItCannotUse) {
  GrayImage image(640, 480);
  for (int y = 0; y < 480; ++y) std::fill_n(image.Row(y), 640, std::uint8_t{90});
  Board board = SmallBoard();
  board.dictionary = "DICT_9X9";
  EXPECT_EQ(DetectBoard(image, board).status().code(), "invalid_board");
  BoardDetectorOptions options;
  options.search_width_px = 10;
  EXPECT_EQ(DetectBoard(image, SmallBoard(), options).status().field(), "board.search_width_px");
  EXPECT_EQ(DetectBoard(GrayImage(), SmallBoard()).status().code(), "invalid_image");
}

}  // namespace
}  // namespace drupe
