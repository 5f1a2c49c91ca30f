#include "capture/calibration/calibrate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "base/files.h"

namespace drupe {
namespace {

constexpr Checkerboard kPattern{.columns = 8, .rows = 6, .square_mm = 5};
constexpr double kDistanceMm = 135;  // from the camera to the middle of the pattern

PinholeCamera TrueCamera() {
  return {.width = 480,
          .height = 360,
          .fx = 700,
          .fy = 700,
          .cx = 245.3,
          .cy = 176.1,
          .dist = {-0.08, 0.02, 3e-4, -2e-4, 0}};
}

/// A pose that looks at the pattern's middle from `distance_mm`, tilted about x and y, with the middle at `centre_px`.
Rigid3 LookAtPattern(double tilt_x, double tilt_y, double distance_mm, const Eigen::Vector2d& centre_px) {
  Rigid3 pose;
  pose.rotation =
      (Eigen::AngleAxisd(tilt_x, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(tilt_y, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.1 * tilt_y, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  const Eigen::Vector2d middle = kPattern.CornerMm(kPattern.CornerCount() - 1) / 2;
  const Eigen::Vector2d ray = TrueCamera().NormalisedFromPixel(centre_px);
  pose.translation =
      distance_mm * Eigen::Vector3d(ray.x(), ray.y(), 1) - pose.rotation * Eigen::Vector3d(middle.x(), middle.y(), 0);
  return pose;
}

/// +1 in squares 0, 2, ..., -1 in the others, and a ramp over `sample_mm` between them, as an area of that size sees
/// it.
double Wave(double mm, double sample_mm) {
  const double phase = mm / kPattern.square_mm;
  const double to_boundary = (phase - std::round(phase)) * kPattern.square_mm;
  const double rising = static_cast<long>(std::round(phase)) % 2 == 0 ? 1 : -1;
  return rising * std::clamp(2 * to_boundary / sample_mm, -1.0, 1.0);
}

/// Grey value of the plane at (x, y) mm: squares within the pattern, white around it.
double PlaneValue(double x, double y, double sample_mm) {
  const double s = kPattern.square_mm;
  const bool on_pattern = x > -s && x < kPattern.columns * s && y > -s && y < kPattern.rows * s;
  return on_pattern ? 122.5 - 92.5 * Wave(x, sample_mm) * Wave(y, sample_mm) : 215;
}

/// Renders the pattern with 2 x 2 samples a pixel, blur and noise, as a PNG.
std::string Render(const Rigid3& pose, unsigned seed) {
  constexpr int kSamples = 2;
  const PinholeCamera camera = TrueCamera();
  cv::Mat large(camera.height * kSamples, camera.width * kSamples, CV_8U);
  const Eigen::Vector3d normal = pose.rotation.col(2);
  const double offset = normal.dot(pose.translation);
  for (int y = 0; y < large.rows; ++y) {
    for (int x = 0; x < large.cols; ++x) {
      const Eigen::Vector2d xy = camera.NormalisedFromPixel({(x + 0.5) / kSamples - 0.5, (y + 0.5) / kSamples - 0.5});
      const Eigen::Vector3d ray(xy.x(), xy.y(), 1);
      const Eigen::Vector3d point = pose.rotation.transpose() * (offset / normal.dot(ray) * ray - pose.translation);
      large.at<uchar>(y, x) = static_cast<uchar>(PlaneValue(point.x(), point.y(), kDistanceMm / camera.fx / kSamples));
    }
  }
  cv::Mat picture, noise(camera.height, camera.width, CV_16S);
  cv::GaussianBlur(large, large, cv::Size(), 0.8 * kSamples);
  cv::resize(large, picture, cv::Size(camera.width, camera.height), 0, 0, cv::INTER_AREA);
  cv::RNG random(seed);
  random.fill(noise, cv::RNG::NORMAL, 0, 1.5);
  cv::add(picture, noise, picture, cv::noArray(), CV_8U);
  std::vector<uchar> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

const std::vector<std::string>& Renderings() {
  static const std::vector<std::string> renderings = [] {
    std::vector<std::string> bytes;
    unsigned seed = 1;
    for (const auto& [tilt_x, tilt_y, x, y] : {std::array{0.5, 0.0, 200.0, 150.0},
                                               {-0.5, 0.1, 280.0, 200.0},
                                               {0.1, 0.6, 220.0, 180.0},
                                               {0.0, -0.6, 260.0, 180.0},
                                               {0.4, 0.4, 160.0, 130.0},
                                               {-0.3, -0.4, 320.0, 230.0},
                                               {0.3, -0.3, 310.0, 140.0},
                                               {0.05, 0.0, 240.0, 180.0}}) {
      bytes.push_back(Render(LookAtPattern(tilt_x, tilt_y, kDistanceMm, {x, y}), seed++));
    }
    return bytes;
  }();
  return renderings;
}

PatternPicture Picture(std::string name, std::string bytes) {
  return {std::move(name), [bytes = std::move(bytes)]() -> Result<std::string> { return bytes; }};
}

std::vector<PatternPicture> Pictures(std::size_t count = 8) {
  std::vector<PatternPicture> pictures;
  for (std::size_t i = 0; i < count; ++i) pictures.push_back(Picture(std::to_string(i) + ".png", Renderings()[i]));
  return pictures;
}

/// The renderings' calibration with default options, which several tests look at.
const Result<CalibrationResult>& Calibrated() {
  static const Result<CalibrationResult> result = RunCalibration(Pictures(), kPattern, {}, {});
  return result;
}

std::string BlankPicture(int width, int height) {
  std::vector<uchar> bytes;
  cv::imencode(".png", cv::Mat(height, width, CV_8U, cv::Scalar(90)), bytes);
  return {bytes.begin(), bytes.end()};
}

TEST(CalibrateTest, FindsTheTrueCamera) {
  const auto& result = Calibrated();
  ASSERT_TRUE(result.ok()) << result.status().ToString();
  const PinholeCamera found = result->calibration.camera, truth = TrueCamera();
  EXPECT_EQ(found.width, truth.width);
  EXPECT_EQ(found.height, truth.height);
  EXPECT_NEAR(found.fx / truth.fx, 1, 5e-4);
  EXPECT_NEAR(found.fy / truth.fy, 1, 5e-4);
  EXPECT_NEAR(found.cx, truth.cx, 0.5);
  EXPECT_NEAR(found.cy, truth.cy, 0.5);
  EXPECT_LT(result->calibration.rms_px, 0.05);
  EXPECT_GT(result->sigma.cx, 0);
  EXPECT_LT(std::abs(found.cx - truth.cx), 5 * result->sigma.cx);
  EXPECT_LT(std::abs(found.fx - truth.fx), 5 * result->sigma.fx);
  for (const PictureReport& picture : result->pictures) EXPECT_TRUE(picture.used) << picture.name << picture.reason;
  EXPECT_NE(result->grade, CalibrationGrade::kPoor) << result->verdict;
}

TEST(CalibrateTest, FindsTheSampleSetsCamera) {
  const std::string set = std::string(DRUPE_TEST_DATA) + "/plum-s/";
  const auto read_json = [](const std::string& path) {
    const auto text = ReadFile(path);
    EXPECT_TRUE(text.ok()) << path;
    return text.ok() ? ParseJson(*text) : Result<Json>(text.status());
  };
  const auto pattern_json = read_json(set + "calibration/pattern.json");
  const auto truth_json = read_json(set + "calibration.json");
  ASSERT_TRUE(pattern_json.ok() && truth_json.ok());
  const auto pattern = ParseCheckerboard(*pattern_json);
  const auto truth = ParseCalibration(*truth_json);
  ASSERT_TRUE(pattern.ok() && truth.ok());
  std::vector<PatternPicture> pictures;
  for (int i = 0; i < 10; ++i) {
    const std::string name = std::to_string(i).insert(0, 1, '0') + ".jpg";
    pictures.push_back({name, [path = set + "calibration/" + name] { return ReadFile(path); }});
  }
  const auto result = RunCalibration(pictures, *pattern, {}, {});
  ASSERT_TRUE(result.ok()) << result.status().ToString();
  EXPECT_NEAR(result->calibration.camera.fx / truth->camera.fx, 1, 2e-4);
  EXPECT_NEAR(result->calibration.camera.cx, truth->camera.cx, 0.4);
  EXPECT_NEAR(result->calibration.camera.cy, truth->camera.cy, 0.4);
  EXPECT_LT(result->calibration.rms_px, 0.03);
  EXPECT_EQ(result->grade, CalibrationGrade::kGood) << result->verdict;
}

TEST(CalibrateTest, MeasuringAgainWithTheCameraHelps) {
  CalibrationOptions once;
  once.refinements = 0;
  const auto first = RunCalibration(Pictures(), kPattern, once, {});
  const auto& refined = Calibrated();
  ASSERT_TRUE(first.ok() && refined.ok());
  EXPECT_LT(refined->calibration.rms_px, 0.7 * first->calibration.rms_px);
}

TEST(CalibrateTest, DoesNotDependOnThreads) {
  RunContext one;
  one.threads = 1;
  const auto again = RunCalibration(Pictures(), kPattern, {}, one);
  ASSERT_TRUE(again.ok() && Calibrated().ok());
  EXPECT_EQ(DumpJson(ToJson(*again)), DumpJson(ToJson(*Calibrated())));
}

TEST(CalibrateTest, LeavesOutPicturesItCannotUseAndSaysWhy) {
  std::vector<PatternPicture> pictures = Pictures(5);
  pictures.push_back(Picture("blank.png", BlankPicture(480, 360)));
  pictures.push_back(Picture("truncated.png", Renderings()[5].substr(0, 4000)));
  cv::Mat small = cv::imdecode(std::vector<uchar>(Renderings()[6].begin(), Renderings()[6].end()), 0);
  cv::resize(small, small, cv::Size(440, 330), 0, 0, cv::INTER_AREA);
  std::vector<uchar> bytes;
  cv::imencode(".png", small, bytes);
  pictures.push_back(Picture("other_size.png", std::string(bytes.begin(), bytes.end())));
  const auto result = RunCalibration(pictures, kPattern, {}, {});
  ASSERT_TRUE(result.ok()) << result.status().ToString();
  ASSERT_EQ(result->pictures.size(), 8U);
  EXPECT_TRUE(result->pictures[4].used);
  EXPECT_NE(result->pictures[5].reason.find("pattern was not found"), std::string::npos);
  EXPECT_NE(result->pictures[6].reason.find("truncated"), std::string::npos);
  EXPECT_NE(result->pictures[7].reason.find("size"), std::string::npos);
  EXPECT_FALSE(result->pictures[7].used);
}

TEST(CalibrateTest, DropsAPictureThatContradictsTheOthers) {
  std::vector<PatternPicture> pictures = Pictures();
  cv::Mat bent = cv::imdecode(std::vector<uchar>(Renderings()[3].begin(), Renderings()[3].end()), 0);
  cv::Mat map_x(bent.size(), CV_32F), map_y(bent.size(), CV_32F);
  for (int y = 0; y < bent.rows; ++y) {
    for (int x = 0; x < bent.cols; ++x) {
      map_x.at<float>(y, x) = static_cast<float>(x + 3 * std::sin(y / 25.0));
      map_y.at<float>(y, x) = static_cast<float>(y);
    }
  }
  cv::remap(bent.clone(), bent, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  std::vector<uchar> bytes;
  cv::imencode(".png", bent, bytes);
  pictures.push_back(Picture("bent.png", std::string(bytes.begin(), bytes.end())));
  const auto result = RunCalibration(pictures, kPattern, {}, {});
  ASSERT_TRUE(result.ok()) << result.status().ToString();
  EXPECT_FALSE(result->pictures.back().used);
  EXPECT_NE(result->pictures.back().reason.find("do not fit"), std::string::npos);
  EXPECT_NEAR(result->calibration.camera.fx / TrueCamera().fx, 1, 5e-4);
}

TEST(CalibrateTest, NeedsThreePictures) {
  const auto result = RunCalibration(Pictures(2), kPattern, {}, {});
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), "too_few_pattern_pictures");
  EXPECT_EQ(result.status().kind(), StatusKind::kUnprocessable);
  EXPECT_EQ(RunCalibration({}, kPattern, {}, {}).status().code(), "too_few_pattern_pictures");
}

TEST(CalibrateTest, StopsWhenCancelled) {
  RunContext context;
  context.cancelled = [] { return true; };
  EXPECT_EQ(RunCalibration(Pictures(), kPattern, {}, context).status().kind(), StatusKind::kCancelled);
}

TEST(CheckerboardTest, ReadsAndChecksThePattern) {
  const auto good =
      ParseCheckerboard(Json{{"pattern", "checkerboard"}, {"inner_corners", {11, 8}}, {"square_mm", 6.0}});
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(good->columns, 11);
  EXPECT_EQ(good->CornerMm(12), Eigen::Vector2d(6, 6));
  const Json json = ToJson(*good);
  const auto field_after = [&](const char* key, const Json& value) {
    Json bad = json;
    bad[key] = value;
    const auto pattern = ParseCheckerboard(bad);
    return pattern.ok() ? std::string("ok") : pattern.status().field();
  };
  EXPECT_EQ(field_after("square_mm", 6), "ok");
  EXPECT_EQ(field_after("pattern", "charuco"), "marker_mm");
  EXPECT_EQ(field_after("pattern", "circles"), "pattern");
  EXPECT_EQ(field_after("pattern", 7), "pattern");
  EXPECT_EQ(field_after("inner_corners", {11, 2}), "inner_corners");
  EXPECT_EQ(field_after("inner_corners", {11, 8, 3}), "inner_corners");
  EXPECT_EQ(field_after("inner_corners", {11, 1e9}), "inner_corners");
  EXPECT_EQ(field_after("square_mm", 0), "square_mm");
  EXPECT_EQ(field_after("square_mm", "6"), "square_mm");
  EXPECT_EQ(ParseCheckerboard(Json::array()).status().code(), "invalid_pattern");
}

}  // namespace
}  // namespace drupe
