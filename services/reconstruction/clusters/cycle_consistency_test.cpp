#include "reconstruction/clusters/cycle_consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "reconstruction/clusters/rotation_averaging.h"

namespace drupe {
namespace {

constexpr int kViews = 24;

/// Camera k of a ring that looks at its middle.
Rigid3 RingPose(int k) {
  const double angle = 2 * M_PI * k / kViews;
  Rigid3 pose;
  pose.rotation =
      (Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()))
          .toRotationMatrix();
  pose.translation = Eigen::Vector3d(0, 0, 10);
  return pose;
}

Eigen::Matrix3d Turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

/// The pairs of neighbours up to three steps apart, round the ring, each a degree off.
MatchGraph Ring() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-1, 1);
  MatchGraph graph;
  for (int a = 0; a < kViews; ++a) {
    for (int b = a + 1; b < kViews; ++b) {
      if (std::min(b - a, kViews - (b - a)) > 3) continue;
      TwoViewMatches pair;
      pair.pair = {a, b};
      pair.second_from_first = RingPose(b) * RingPose(a).Inverse();
      pair.second_from_first.rotation =
          Turn(0.017, Eigen::Vector3d(noise(random), noise(random), noise(random))) * pair.second_from_first.rotation;
      pair.second_from_first.translation.normalize();
      pair.calibrated = true;
      pair.matches.resize(100);
      graph.pairs.push_back(pair);
    }
  }
  return graph;
}

TwoViewMatches& Find(MatchGraph& graph, int first, int second) {
  return *std::find_if(graph.pairs.begin(), graph.pairs.end(), [&](const TwoViewMatches& pair) {
    return pair.pair == ImagePair{first, second};
  });
}

void AddWrongPair(MatchGraph& graph, int first, int second, double angle) {
  TwoViewMatches pair = Find(graph, first, first + 1);
  pair.pair = {first, second};
  pair.second_from_first.rotation = Turn(angle, Eigen::Vector3d(1, -2, 0.5));
  graph.pairs.push_back(pair);
  std::sort(graph.pairs.begin(), graph.pairs.end(), [](const auto& a, const auto& b) {
    return std::pair(a.pair.first, a.pair.second) < std::pair(b.pair.first, b.pair.second);
  });
}

TEST(CycleConsistencyTest, KeepsARingThatIsRight) {
  MatchGraph graph = Ring();
  const std::size_t before = graph.pairs.size();
  const Result<CycleReport> report = DropInconsistentPairs(kViews, {}, graph);
  ASSERT_TRUE(report.ok());
  EXPECT_TRUE(report->dropped.empty());
  EXPECT_EQ(graph.pairs.size(), before);
  EXPECT_EQ(report->triplets, 3 * kViews);  // steps 1 + 1 and 1 + 2 and 2 + 1
}

TEST(CycleConsistencyTest, DropsWrongRotationsAndNothingElse) {
  MatchGraph graph = Ring();
  Find(graph, 4, 6).second_from_first.rotation = Turn(1.4, Eigen::Vector3d(0, 1, 0.2));
  Find(graph, 4, 6).matches.resize(500);  // however many matches
  Find(graph, 10, 11).second_from_first.rotation = Turn(0.5, Eigen::Vector3d(1, 0, 0));
  AddWrongPair(graph, 2, 14, 2.5);  // closes no triplet
  AddWrongPair(graph, 8, 20, 1.6);
  const std::size_t before = graph.pairs.size();
  const Result<CycleReport> report = DropInconsistentPairs(kViews, {}, graph);
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->dropped, (std::vector<ImagePair>{{2, 14}, {4, 6}, {8, 20}, {10, 11}}));
  EXPECT_EQ(graph.pairs.size(), before - 4);
}

TEST(CycleConsistencyTest, DropsAConsistentMinorityOfAliasedPairs) {
  MatchGraph graph = Ring();
  // A pattern with a period: views a quarter turn apart match as if they were the same place.
  for (int a = 0; a < 3; ++a) AddWrongPair(graph, a, a + 6, 0.01);
  const Result<CycleReport> report = DropInconsistentPairs(kViews, {}, graph);
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->dropped, (std::vector<ImagePair>{{0, 6}, {1, 7}, {2, 8}}));
}

TEST(CycleConsistencyTest, DropsADirectionThatFormsNoTriangle) {
  MatchGraph graph = Ring();
  Find(graph, 7, 10).second_from_first.translation = Eigen::Vector3d(0.3, -1, 0).normalized();
  Find(graph, 15, 18).second_from_first.translation = Eigen::Vector3d(0, 1, 0);
  const Result<CycleReport> report = DropInconsistentPairs(kViews, {}, graph);
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->dropped, (std::vector<ImagePair>{{7, 10}, {15, 18}}));
}

TEST(CycleConsistencyTest, KeepsWhatItCannotJudge) {
  MatchGraph graph;
  TwoViewMatches alone;
  alone.pair = {0, 1};
  alone.calibrated = true;
  alone.second_from_first.translation = Eigen::Vector3d::UnitX();
  TwoViewMatches unknown;
  unknown.pair = {1, 2};
  graph.pairs = {alone, unknown};
  ASSERT_TRUE(DropInconsistentPairs(4, {}, graph).ok());
  EXPECT_EQ(graph.pairs.size(), 2u);
  MatchGraph none;
  EXPECT_TRUE(DropInconsistentPairs(0, {}, none).ok());
}

TEST(CycleConsistencyTest, RefusesBadInput) {
  MatchGraph graph = Ring();
  EXPECT_EQ(DropInconsistentPairs(kViews - 1, {}, graph).status().code(), "invalid_pair");
  std::swap(graph.pairs[0], graph.pairs[1]);
  EXPECT_EQ(DropInconsistentPairs(kViews, {}, graph).status().code(), "invalid_pair");
  EXPECT_EQ(CycleOptions{.max_rotation_deg = 0}.Check().field(), "max_rotation_deg");
  EXPECT_EQ(CycleOptions{.max_direction_deg = NAN}.Check().field(), "max_direction_deg");
}

TEST(RotationAveragingTest, IsMoreExactThanTheMeasurements) {
  MatchGraph graph = Ring();
  std::vector<RelativeRotation> measured;
  for (const TwoViewMatches& pair : graph.pairs) {
    measured.push_back({pair.pair.first, pair.pair.second, pair.second_from_first.rotation, 1.0});
  }
  const std::vector<Eigen::Matrix3d> rotations = AverageRotations(kViews, measured, 0.1);
  double sum = 0;
  for (int k = 0; k + 1 < kViews; ++k) {
    const Eigen::Matrix3d expected = RingPose(k + 1).rotation * RingPose(k).rotation.transpose();
    sum += Eigen::AngleAxisd(expected.transpose() * rotations[k + 1] * rotations[k].transpose()).angle();
  }
  EXPECT_LT(sum / (kViews - 1), 0.7 * 0.017);
}

}  // namespace
}  // namespace drupe
