#include "reconstruction/clusters/clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "reconstruction/clusters/normalised_cut.h"
#include "reconstruction/clusters/overlap.h"

namespace drupe {
namespace {

/// A ring of images whose likeness falls with their distance along it.
SimilarityGraph Ring(int count) {
  SimilarityGraph graph;
  graph.image_count = count;
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      const int apart = std::min(std::abs(a - b), count - std::abs(a - b));
      graph.fisher_distance.push_back(static_cast<float>(1 - std::exp(-apart / 4.0)));
    }
  }
  const float extreme = *std::max_element(graph.fisher_distance.begin(), graph.fisher_distance.end());
  for (const float distance : graph.fisher_distance) graph.weight.push_back(extreme - distance);
  return graph;
}

TEST(NormalisedCutTest, SeparatesTwoGroups) {
  SimilarityGraph graph;
  graph.image_count = 7;
  for (int a = 0; a < 7; ++a) {
    for (int b = 0; b < 7; ++b) graph.weight.push_back(a != b && a % 2 == b % 2 ? 1.0f : 0.1f);
  }
  const auto [left, right] = NormalisedCut(graph, {0, 1, 2, 3, 4, 5, 6});
  const std::set<std::vector<int>> sides = {left, right};
  EXPECT_EQ(sides, (std::set<std::vector<int>>{{0, 2, 4, 6}, {1, 3, 5}}));
}

TEST(NormalisedCutTest, CutsAGraphWithoutEdges) {
  SimilarityGraph graph;
  graph.image_count = 4;
  graph.weight.assign(16, 0);
  const auto [left, right] = NormalisedCut(graph, {0, 1, 2, 3});
  EXPECT_EQ(left.size() + right.size(), 4u);
  EXPECT_FALSE(left.empty());
  EXPECT_FALSE(right.empty());
}

TEST(ClustersTest, KeepsThePapersBounds) {
  for (const int count : {36, 72, 100}) {
    const Result<ViewClusters> clusters = RunClusters(Ring(count), {}, {});
    ASSERT_TRUE(clusters.ok());
    std::set<int> seen;
    for (std::size_t c = 0; c < clusters->clusters.size(); ++c) {
      EXPECT_LE(clusters->clusters[c].size(), 12u);
      EXPECT_GE(OverlapOf(clusters->clusters, c), 0.6) << "cluster " << c << " of " << count;
      seen.insert(clusters->clusters[c].begin(), clusters->clusters[c].end());
    }
    EXPECT_EQ(static_cast<int>(seen.size()), count);
  }
}

TEST(ClustersTest, ClosesTheRing) {
  const Result<ViewClusters> clusters = RunClusters(Ring(36), {}, {});
  ASSERT_TRUE(clusters.ok());
  for (int image = 0; image < 36; ++image) {
    for (int step = 1; step <= 2; ++step) {
      const int other = (image + step) % 36;
      const ImagePair pair{std::min(image, other), std::max(image, other)};
      EXPECT_NE(std::find(clusters->pairs.begin(), clusters->pairs.end(), pair), clusters->pairs.end())
          << pair.first << " " << pair.second;
    }
  }
}

TEST(ClustersTest, PairsAreUniqueAndGrowLinearly) {
  std::vector<double> per_image;
  for (const int count : {36, 144}) {
    const Result<ViewClusters> clusters = RunClusters(Ring(count), {}, {});
    ASSERT_TRUE(clusters.ok());
    std::set<std::pair<int, int>> unique;
    for (const ImagePair& pair : clusters->pairs) {
      EXPECT_LT(pair.first, pair.second);
      unique.emplace(pair.first, pair.second);
    }
    EXPECT_EQ(unique.size(), clusters->pairs.size());
    per_image.push_back(static_cast<double>(unique.size()) / count);
  }
  EXPECT_NEAR(per_image[1] / per_image[0], 1, 0.2);
}

TEST(ClustersTest, SmallSetsAreMatchedExhaustively) {
  const Result<ViewClusters> clusters = RunClusters(Ring(19), {}, {});
  ASSERT_TRUE(clusters.ok());
  EXPECT_EQ(clusters->clusters.size(), 1u);
  EXPECT_EQ(clusters->pairs.size(), 19u * 18 / 2);
}

TEST(ClustersTest, RefusesBadInput) {
  EXPECT_EQ(RunClusters(Ring(1), {}, {}).status().code(), "too_few_images");
  SimilarityGraph torn = Ring(5);
  torn.weight.pop_back();
  EXPECT_EQ(RunClusters(torn, {}, {}).status().code(), "invalid_graph");
  ViewClusterOptions options;
  options.max_cluster_size = 2;
  EXPECT_EQ(RunClusters(Ring(5), options, {}).status().field(), "max_cluster_size");
}

}  // namespace
}  // namespace drupe
