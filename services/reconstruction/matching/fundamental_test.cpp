// Epipolar geometry without a calibration: seven-point solver, fundamental matrix, scenes that are nearly a plane.
#include "reconstruction/matching/fundamental.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "reconstruction/matching/plane_parallax.h"
#include "reconstruction/matching/seven_point.h"

namespace drupe {
namespace {

/// Pairs of two pictures of a lens of which nothing is known: a scene at depths of 4 to 8 baselines, part of it in one
/// plane, part of the matches wrong.
class UnknownLensScene {
 public:
  struct Shares {
    int pairs = 300;
    double in_plane = 0;
    double wrong = 0;  ///< of all, the last ones
    double noise = 2e-4;
  };

  explicit UnknownLensScene(const Shares& shares) : random_(29) {
    pose_.rotation = Eigen::AngleAxisd(0.17, Eigen::Vector3d(0.1, 0.97, 0.2).normalized()).toRotationMatrix();
    pose_.translation = Eigen::Vector3d(-0.95, 0.1, 0.08).normalized();
    lens_ << 1.7, 0, 0.03, 0, 1.65, -0.02, 0, 0, 1;
    const int wrong_from = static_cast<int>(std::lround((1 - shares.wrong) * shares.pairs));
    const double plane_to = shares.in_plane * wrong_from;
    for (int i = 0; i < shares.pairs; ++i) pairs_.push_back(Pair(i < plane_to, i >= wrong_from, shares.noise));
    right_ = wrong_from;
  }

  const std::vector<PointPair>& pairs() const { return pairs_; }
  int right() const { return right_; }  ///< the first so many pairs are right

  /// Root mean square Sampson distance of new, exact points of the whole depth.
  double ErrorOf(const Eigen::Matrix3d& f) {
    double sum = 0;
    for (int i = 0; i < 500; ++i) sum += SquaredSampson(f, Pair(false, false, 0));
    return std::sqrt(sum / 500);
  }

 private:
  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  Eigen::Vector2d Place() { return {Uniform(-0.5, 0.5), Uniform(-0.35, 0.35)}; }

  PointPair Pair(bool in_plane, bool wrong, double noise) {
    const Eigen::Vector2d first = Place();
    const Eigen::Vector3d ray = lens_.inverse() * first.homogeneous();
    const double depth = in_plane ? 6 / (1 + 0.5 * ray.x() + 1.2 * ray.y()) : Uniform(4, 8);
    const Eigen::Vector2d second = (lens_ * (pose_ * Eigen::Vector3d(depth * ray))).hnormalized();
    const Eigen::Vector2d shake(Uniform(-noise, noise), Uniform(-noise, noise));
    return {first, wrong ? Place() : Eigen::Vector2d(second + shake)};
  }

  std::mt19937_64 random_;
  Rigid3 pose_;
  Eigen::Matrix3d lens_;
  std::vector<PointPair> pairs_;
  int right_ = 0;
};

constexpr double kMaxError = 1e-3;

RansacOptions Ransac() {
  return {kMaxError, 0.9999, 2000, 1};
}

int CountRight(const std::vector<int>& inliers, int right) {
  return static_cast<int>(std::count_if(inliers.begin(), inliers.end(), [right](int i) { return i < right; }));
}

/// OpenCV's estimate of the same pairs, its coordinates scaled to pixels of about the size that it expects.
Eigen::Matrix3d EstimateByOpenCv(const std::vector<PointPair>& pairs) {
  constexpr double kPixels = 1000;
  std::vector<cv::Point2d> first, second;
  for (const PointPair& pair : pairs) {
    first.emplace_back(kPixels * pair.first.x(), kPixels * pair.first.y());
    second.emplace_back(kPixels * pair.second.x(), kPixels * pair.second.y());
  }
  const cv::Mat found = cv::findFundamentalMat(first, second, cv::FM_RANSAC, kPixels * kMaxError, 0.9999, 2000);
  Eigen::Matrix3d f;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) f(r, c) = found.at<double>(r, c) * (r < 2 ? kPixels : 1) * (c < 2 ? kPixels : 1);
  }
  return f.normalized();
}

TEST(SevenPointTest, SolutionsHaveRankTwoAndFitAndOneIsTheTruth) {
  UnknownLensScene scene({.pairs = 70, .noise = 0});
  for (int trial = 0; trial < 10; ++trial) {
    std::array<PointPair, 7> sample;
    std::copy_n(scene.pairs().begin() + 7 * trial, 7, sample.begin());
    const std::vector<Eigen::Matrix3d> solutions = SolveSevenPoint(sample);
    ASSERT_TRUE(solutions.size() == 1 || solutions.size() == 3);
    double best = 1;
    for (const Eigen::Matrix3d& f : solutions) {
      EXPECT_NEAR(f.determinant(), 0, 1e-10);
      for (const PointPair& pair : sample) {
        EXPECT_NEAR(pair.second.homogeneous().dot(f * pair.first.homogeneous()), 0, 1e-10);
      }
      best = std::min(best, scene.ErrorOf(f));
    }
    EXPECT_LT(best, 1e-5);
  }
}

TEST(SevenPointTest, RepeatedPointsGiveNoNonsense) {
  std::array<PointPair, 7> sample;
  sample.fill({{0.1, 0.2}, {0.12, 0.2}});
  for (const Eigen::Matrix3d& f : SolveSevenPoint(sample)) EXPECT_TRUE(f.allFinite());
}

TEST(FundamentalTest, SurvivesHalfOutliers) {
  UnknownLensScene scene({.wrong = 0.5});
  const auto estimate = EstimateFundamental(scene.pairs(), Ransac());
  ASSERT_TRUE(estimate.has_value());
  EXPECT_LT(scene.ErrorOf(estimate->matrix), 2e-4);
  EXPECT_NEAR(estimate->matrix.determinant(), 0, 1e-12);
  const int right = CountRight(estimate->inliers, scene.right());
  EXPECT_GT(right, 0.98 * scene.right());
  EXPECT_LT(static_cast<int>(estimate->inliers.size()) - right, 10);
}

TEST(FundamentalTest, IsAsExactAsOpenCvs) {
  for (const double wrong : {0.0, 0.3, 0.5}) {
    UnknownLensScene scene({.wrong = wrong});
    const auto estimate = EstimateFundamental(scene.pairs(), Ransac());
    ASSERT_TRUE(estimate.has_value());
    EXPECT_LE(scene.ErrorOf(estimate->matrix), scene.ErrorOf(EstimateByOpenCv(scene.pairs())));
  }
}

/// 92 of 100 right matches lie in a plane: nearly every sample fixes nothing but the plane.
TEST(FundamentalTest, FindsTheFewPointsOffAPlane) {
  UnknownLensScene scene({.pairs = 400, .in_plane = 0.92, .wrong = 0.25});
  const auto estimate = EstimateFundamental(scene.pairs(), Ransac());
  ASSERT_TRUE(estimate.has_value());
  EXPECT_LT(scene.ErrorOf(estimate->matrix), 5e-4);
  EXPECT_GT(CountRight(estimate->inliers, scene.right()), 0.98 * scene.right());
  // An estimate that does not know of planes leaves a good part of the points off the plane out.
  const double of_opencv = scene.ErrorOf(EstimateByOpenCv(scene.pairs()));
  EXPECT_LT(scene.ErrorOf(estimate->matrix), of_opencv);
}

TEST(FundamentalTest, ASampleInAPlaneIsRecognised) {
  UnknownLensScene scene({.pairs = 14, .in_plane = 0.5, .noise = 0});
  std::array<PointPair, 7> flat, solid;
  std::copy_n(scene.pairs().begin(), 5, flat.begin());
  std::copy_n(scene.pairs().begin() + 7, 2, flat.begin() + 5);
  std::copy_n(scene.pairs().begin() + 7, 7, solid.begin());
  for (const Eigen::Matrix3d& f : SolveSevenPoint(flat)) EXPECT_TRUE(PlaneOfSample(f, flat, kMaxError).has_value());
  for (const Eigen::Matrix3d& f : SolveSevenPoint(solid)) EXPECT_FALSE(PlaneOfSample(f, solid, kMaxError).has_value());
}

TEST(FundamentalTest, PlaneAloneIsExplainedSomehow) {
  UnknownLensScene scene({.pairs = 100, .in_plane = 1});
  const auto estimate = EstimateFundamental(scene.pairs(), Ransac());
  ASSERT_TRUE(estimate.has_value());
  EXPECT_GT(estimate->inliers.size(), 98u);
}

TEST(FundamentalTest, IsTheSameForTheSameSeedAndNeedsSevenPairs) {
  UnknownLensScene scene({.pairs = 80, .wrong = 0.3});
  const auto a = EstimateFundamental(scene.pairs(), Ransac()), b = EstimateFundamental(scene.pairs(), Ransac());
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->matrix, b->matrix);
  EXPECT_EQ(a->inliers, b->inliers);
  EXPECT_FALSE(EstimateFundamental(std::span(scene.pairs()).first(6), Ransac()).has_value());
}

TEST(TransferTest, OfAnEssentialMatrixIsItsPose) {
  Rigid3 pose;
  pose.rotation = Eigen::AngleAxisd(0.2, Eigen::Vector3d(0.2, 0.9, 0.1).normalized()).toRotationMatrix();
  pose.translation = Eigen::Vector3d(-0.9, 0.2, 0.1).normalized();
  const EpipolarTransfer transfer = TransferFromFundamental(3 * EssentialFromPose(pose), pose);
  EXPECT_LT((transfer.at_infinity - pose.rotation).norm(), 1e-9);
  EXPECT_LT((transfer.epipole - pose.translation).norm(), 1e-9);
  const Eigen::Vector3d point(0.4, -0.3, 5);
  const PointPair pair{point.hnormalized(), (pose * point).hnormalized()};
  EXPECT_NEAR(InverseDepthOf(transfer, pair), 1 / 5.0, 1e-12);
}

}  // namespace
}  // namespace drupe
