#include "cli/bench/colour_clusters.h"

#include <gtest/gtest.h>

#include <random>

namespace drupe {
namespace {

// Two clouds of colours 10 apart, the second a tenth of the points.
std::vector<Eigen::Vector3f> TwoClouds() {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 0.5f);
  std::vector<Eigen::Vector3f> colours;
  for (int k = 0; k < 2000; ++k) {
    colours.emplace_back((k % 10 == 0 ? 10.0f : 0.0f) + normal(random), normal(random), normal(random));
  }
  return colours;
}

TEST(ColourClusters, OpenCvFindsTwoCloudsAndTheIndexSaysSo) {
  const ColourClusters two = ClusterByOpenCv(TwoClouds(), 2, true);
  const ColourClusters five = ClusterByOpenCv(TwoClouds(), 5, true);
  // Mean distance from the centre of a ball of deviation 0.5 is 0.8: (0.8 + 0.8) / 10.
  EXPECT_NEAR(DaviesBouldinIndex(two).value(), 0.16, 0.01);
  EXPECT_GT(DaviesBouldinIndex(five).value(), 0.5);
  std::vector<std::uint8_t> truth;
  for (int k = 0; k < 2000; ++k) truth.push_back(k % 10 == 0 ? 1 : 0);
  EXPECT_DOUBLE_EQ(DefectAgreement(two, truth, false).value(), 1);
}

TEST(ColourClusters, NearestCentresDivideTwoCloudsAsKMeansDoes) {
  const ColourClusters nearest = ClusterByNearest(TwoClouds(), {Eigen::Vector3f(0.2f, 0, 0), Eigen::Vector3f(9, 0, 0)});
  EXPECT_EQ(nearest.classes, 2);
  EXPECT_NEAR(DaviesBouldinIndex(nearest).value(), 0.16, 0.01);
  for (std::size_t k = 0; k < nearest.class_of.size(); ++k) ASSERT_EQ(nearest.class_of[k], k % 10 == 0 ? 1 : 0);
}

TEST(ColourClusters, AgreementIsIntersectionOverUnion) {
  ColourClusters clusters;
  clusters.class_of = {0, 0, 1, 1, 2, 2};
  clusters.classes = 3;
  const std::vector<std::uint8_t> truth = {0, 0, 1, 0, 1, 1};
  EXPECT_DOUBLE_EQ(DefectAgreement(clusters, truth, true).value(), 0.75);
  EXPECT_DOUBLE_EQ(DefectAgreement(clusters, truth, false).value(), 0.75);
  EXPECT_DOUBLE_EQ(DefectAgreement(clusters, {0, 1, 0, 0, 0, 0}, true).value(), 0);
  EXPECT_FALSE(DefectAgreement(clusters, std::vector<std::uint8_t>(6, 0), true).has_value());
}

TEST(ColourClusters, OneClassHasNoIndex) {
  ColourClusters clusters;
  clusters.colours = TwoClouds();
  clusters.class_of.assign(clusters.colours.size(), 0);
  clusters.classes = 1;
  EXPECT_FALSE(DaviesBouldinIndex(clusters).has_value());
}

}  // namespace
}  // namespace drupe
