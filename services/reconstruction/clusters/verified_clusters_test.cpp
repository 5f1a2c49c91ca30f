#include "reconstruction/clusters/verified_clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "reconstruction/clusters/overlap.h"

namespace drupe {
namespace {

/// A ring whose neighbours share `close` matches, falling to a tenth three steps apart.
MatchGraph VerifiedRing(int count, int close) {
  MatchGraph graph;
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      const int apart = std::min(b - a, count - (b - a));
      if (apart > 3) continue;
      TwoViewMatches pair;
      pair.pair = {a, b};
      pair.matches.resize(apart == 1 ? close : apart == 2 ? close / 3 : close / 10);
      graph.pairs.push_back(pair);
    }
  }
  return graph;
}

/// True for an arc of the ring: at most one gap when gone round.
bool IsContiguous(const std::vector<int>& cluster, int count) {
  int gaps = 0;
  for (std::size_t k = 0; k < cluster.size(); ++k) {
    gaps += (cluster[k] + 1) % count != cluster[(k + 1) % cluster.size()] ? 1 : 0;
  }
  return gaps <= 1;
}

TEST(VerifiedClustersTest, AreArcsOfTheRingWithThePapersBounds) {
  for (const int count : {36, 72, 150}) {
    const Result<ViewClusters> clusters = ClusterVerified(count, VerifiedRing(count, 900), {});
    ASSERT_TRUE(clusters.ok());
    std::set<int> seen;
    for (std::size_t k = 0; k < clusters->clusters.size(); ++k) {
      const std::vector<int>& cluster = clusters->clusters[k];
      EXPECT_LE(cluster.size(), 12u);
      EXPECT_GE(cluster.size(), 4u);
      EXPECT_TRUE(IsContiguous(cluster, count)) << "cluster " << k << " of " << count;
      EXPECT_GE(OverlapOf(clusters->clusters, k), 0.7) << "cluster " << k << " of " << count;
      seen.insert(cluster.begin(), cluster.end());
      for (const int end : {cluster.front(), cluster.back()}) {
        const int after = (end + 1) % count;  // two neighbours are together somewhere: no seam runs between them
        EXPECT_TRUE(std::any_of(clusters->clusters.begin(), clusters->clusters.end(),
                                [&](const std::vector<int>& c) {
                                  return std::count(c.begin(), c.end(), end) + std::count(c.begin(), c.end(), after) ==
                                         2;
                                }))
            << end << " of " << count;
      }
    }
    EXPECT_EQ(static_cast<int>(seen.size()), count);
    EXPECT_GE(clusters->clusters.size(), static_cast<std::size_t>(count / 12));
  }
}

TEST(VerifiedClustersTest, AFewAliasedPairsDoNotTearThem) {
  MatchGraph graph = VerifiedRing(36, 900);
  for (int a = 0; a < 9; a += 3) {
    TwoViewMatches pair;
    pair.pair = {a, a + 18};
    pair.matches.resize(60);
    graph.pairs.push_back(pair);
  }
  const Result<ViewClusters> clusters = ClusterVerified(36, graph, {});
  ASSERT_TRUE(clusters.ok());
  for (const std::vector<int>& cluster : clusters->clusters) EXPECT_TRUE(IsContiguous(cluster, 36));
}

TEST(VerifiedClustersTest, SmallSetsStayWhole) {
  const Result<ViewClusters> clusters = ClusterVerified(18, VerifiedRing(18, 900), {});
  ASSERT_TRUE(clusters.ok());
  EXPECT_EQ(clusters->clusters.size(), 1u);
  EXPECT_EQ(clusters->pairs.size(), 18u * 3);
}

TEST(VerifiedClustersTest, PicturesWithoutPairsAreInNone) {
  MatchGraph graph = VerifiedRing(40, 300);
  std::erase_if(graph.pairs, [](const TwoViewMatches& p) { return p.pair.first == 7 || p.pair.second == 7; });
  const Result<ViewClusters> clusters = ClusterVerified(40, graph, {});
  ASSERT_TRUE(clusters.ok());
  for (const auto& cluster : clusters->clusters) EXPECT_EQ(std::count(cluster.begin(), cluster.end(), 7), 0);
  const Result<ViewClusters> none = ClusterVerified(5, MatchGraph{}, {});
  ASSERT_TRUE(none.ok());
  EXPECT_TRUE(none->clusters.empty());
}

TEST(VerifiedClustersTest, RefusesAPairOfNoPicture) {
  EXPECT_EQ(ClusterVerified(35, VerifiedRing(36, 900), {}).status().code(), "invalid_pair");
}

}  // namespace
}  // namespace drupe
