// Our SIFT beside OpenCV's on the same pair of pictures: it must match no worse.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
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
/// Percent by which ours may be below OpenCV's.
constexpr double kSlack = 2;

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

/// Percent of the features of `a` near whose place in the other picture, as map(place) gives it, there is one of `b`,
/// of those whose place lies inside it.
template <typename Map>
double Repeatability(const Described& a, const Described& b, const GrayImage& other, const Map& map) {
  constexpr float kNear = 1.5;
  int found = 0, inside = 0;
  for (const Eigen::Vector2f& place : a.places) {
    const Eigen::Vector2f expected = map(place);
    if (expected.minCoeff() < 0 || expected.x() >= other.width() || expected.y() >= other.height()) continue;
    ++inside;
    found += std::any_of(b.places.begin(), b.places.end(),
                         [&](const Eigen::Vector2f& there) { return (there - expected).norm() < kNear; });
  }
  return 100.0 * found / inside;
}

/// Holds both scores of a picture and a changed one, in which a place is found at map(place), against OpenCV's.
template <typename Map>
void ExpectNoWorse(const GrayImage& image, const GrayImage& changed, const Map& map) {
  const auto is_right = [&](const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return (map(a) - b).norm() < 1.5; };
  const Described ours[] = {Ours(image), Ours(changed)}, theirs[] = {Theirs(image), Theirs(changed)};
  const double our_score = MatchingScore(ours[0], ours[1], is_right);
  const double their_score = MatchingScore(theirs[0], theirs[1], is_right);
  EXPECT_GT(our_score, 20);
  EXPECT_GT(our_score, their_score - kSlack) << "OpenCV " << their_score;
  const double our_share = Repeatability(ours[0], ours[1], changed, map);
  const double their_share = Repeatability(theirs[0], theirs[1], changed, map);
  EXPECT_GT(our_share, 30);
  EXPECT_GT(our_share, their_share - kSlack) << "OpenCV " << their_share;
}

TEST(OpenCvComparisonTest, TurnedFruitMatchesNoWorse) {
  // The board's near corner; the turntable carries it to the left from one picture to the next.
  const GrayImage first = Crop(Load("00.jpg"), 300, 250, 640, 420), second = Crop(Load("01.jpg"), 300, 250, 640, 420);
  const auto moves_little = [](const Eigen::Vector2f& a, const Eigen::Vector2f& b) { return (a - b).norm() < 150; };
  const double ours = MatchingScore(Ours(first), Ours(second), moves_little);
  const double theirs = MatchingScore(Theirs(first), Theirs(second), moves_little);
  EXPECT_GT(theirs, 10);
  EXPECT_GT(ours, theirs - kSlack) << "OpenCV " << theirs;
}

TEST(OpenCvComparisonTest, QuarterTurnRepeatsNoWorse) {
  const GrayImage upright = Crop(Load("00.jpg"), 400, 200, 400, 400);
  GrayImage turned(400, 400);
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) turned.At(399 - y, x) = upright.At(x, y);
  }
  ExpectNoWorse(upright, turned, [](const Eigen::Vector2f& a) { return Eigen::Vector2f(399 - a.y(), a.x()); });
}

TEST(OpenCvComparisonTest, SmallerAndDarkerRepeatsNoWorse) {
  constexpr double kScale = 0.7, kGain = 0.6;
  const GrayImage image = Crop(Load("00.jpg"), 400, 200, 400, 400);
  const cv::Mat view(image.height(), image.width(), CV_8U, const_cast<std::uint8_t*>(image.Row(0)),
                     static_cast<std::size_t>(image.stride()));
  cv::Mat small;
  cv::resize(view, small, {}, kScale, kScale, cv::INTER_AREA);
  GrayImage changed(small.cols, small.rows);
  for (int y = 0; y < small.rows; ++y) {
    for (int x = 0; x < small.cols; ++x) {
      changed.At(x, y) = static_cast<std::uint8_t>(kGain * small.at<std::uint8_t>(y, x));
    }
  }
  ExpectNoWorse(image, changed, [](const Eigen::Vector2f& a) {
    return Eigen::Vector2f((a.array() + 0.5f) * static_cast<float>(kScale) - 0.5f);
  });
}

}  // namespace
}  // namespace drupe
