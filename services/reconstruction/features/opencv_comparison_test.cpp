// Our SIFT beside OpenCV's on the same pair of pictures: it must match no worse.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

#include "base/files.h"
#include "image/decode.h"
#include "reconstruction/features/features.h"

namespace drupe {
namespace {

struct Described {
  std::vector<Eigen::Vector2f> places;
  Eigen::MatrixXf descriptors;  ///< 128 x n, unit length
};

GrayImage Load(const std::string& name) {
  return DecodeGray(ReadFile(std::string(DRUPE_TEST_DATA) + "/plum-s/images/" + name).value()).value();
}

/// The upper left part of a picture at the given offset.
GrayImage Crop(const GrayImage& image, int x0, int y0, int width, int height) {
  GrayImage crop(width, height);
  for (int y = 0; y < height; ++y) std::copy_n(image.Row(y0 + y) + x0, width, crop.Row(y));
  return crop;
}

constexpr double kPeak = 0.02;

Described Ours(const GrayImage& image) {
  FeatureOptions options;
  options.first_octave = -1;  // OpenCV begins with the picture doubled
  options.max_features = 1'000'000;
  options.peak_threshold = kPeak;
  const Features features = RunFeatures(image, options, RunContext()).value();
  Described described;
  described.descriptors.resize(128, static_cast<Eigen::Index>(features.size()));
  for (std::size_t i = 0; i < features.size(); ++i) {
    described.places.emplace_back(features.keypoints[i].x, features.keypoints[i].y);
    for (int k = 0; k < 128; ++k) described.descriptors(k, static_cast<Eigen::Index>(i)) = features.Descriptor(i)[k];
  }
  described.descriptors.colwise().normalize();
  return described;
}

Described Theirs(const GrayImage& image) {
  const cv::Mat view(image.height(), image.width(), CV_8U, const_cast<std::uint8_t*>(image.Row(0)),
                     static_cast<std::size_t>(image.stride()));
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  cv::SIFT::create(0, 3, kPeak, 10, 1.6)->detectAndCompute(view, {}, keypoints, descriptors);
  Described described;
  described.descriptors.resize(128, static_cast<Eigen::Index>(keypoints.size()));
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    described.places.emplace_back(keypoints[i].pt.x, keypoints[i].pt.y);
    const float* row = descriptors.ptr<float>(static_cast<int>(i));
    for (int k = 0; k < 128; ++k) described.descriptors(k, static_cast<Eigen::Index>(i)) = std::sqrt(row[k]);
  }
  described.descriptors.colwise().normalize();
  return described;
}

/// Percent of the features that are matched (ratio 0.7, mutual) and obey `is_right`.
template <typename IsRight>
double MatchingScore(const Described& a, const Described& b, const IsRight& is_right) {
  const Eigen::MatrixXf cosines = b.descriptors.transpose() * a.descriptors;
  int right = 0;
  for (Eigen::Index i = 0; i < cosines.cols(); ++i) {
    Eigen::Index best = 0, back = 0;
    const float nearest = cosines.col(i).maxCoeff(&best);
    float second = -1;
    for (Eigen::Index j = 0; j < cosines.rows(); ++j) {
      if (j != best) second = std::max(second, cosines(j, i));
    }
    cosines.row(best).maxCoeff(&back);
    if (back == i && 1 - nearest < 0.49f * (1 - second) && is_right(a.places[i], b.places[best])) ++right;
  }
  return 100.0 * right / static_cast<double>(std::min(a.places.size(), b.places.size()));
}

TEST(OpenCvComparisonTest, TurnedFruitMatchesNoWorse) {
  // The board's near corner; the turntable carries it to the left from one picture to the next.
  const GrayImage first = Crop(Load("00.jpg"), 300, 250, 640, 420), second = Crop(Load("01.jpg"), 300, 250, 640, 420);
  const auto moves_little = [](const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return (a - b).norm() < 150; };
  const double ours = MatchingScore(Ours(first), Ours(second), moves_little);
  const double theirs = MatchingScore(Theirs(first), Theirs(second), moves_little);
  EXPECT_GT(theirs, 10);
  EXPECT_GT(ours, theirs - 2) << "OpenCV " << theirs;
}

TEST(OpenCvComparisonTest, QuarterTurnRepeatsNoWorse) {
  const GrayImage upright = Crop(Load("00.jpg"), 400, 200, 400, 400);
  GrayImage turned(400, 400);
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) turned.At(399 - y, x) = upright.At(x, y);
  }
  const auto is_right = [](const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
    return (Eigen::Vector2f(399 - a.y(), a.x()) - b).norm() < 1;
  };
  const double ours = MatchingScore(Ours(upright), Ours(turned), is_right);
  const double theirs = MatchingScore(Theirs(upright), Theirs(turned), is_right);
  EXPECT_GT(ours, 80);
  EXPECT_GT(ours, theirs - 2) << "OpenCV " << theirs;
}

}  // namespace
}  // namespace drupe
