#include "reconstruction/clusters/overlap.h"

#include <algorithm>

namespace drupe {
namespace {

bool Contains(const std::vector<int>& cluster, int image) {
  return std::binary_search(cluster.begin(), cluster.end(), image);
}

/// The image outside the cluster that has the strongest single edge into it; -1 when there is none outside.
int MostSimilarOutside(const SimilarityGraph& graph, const std::vector<int>& cluster) {
  int best = -1;
  float strongest = -1;
  for (int image = 0; image < graph.image_count; ++image) {
    if (Contains(cluster, image)) continue;
    for (const int inside : cluster) {
      if (graph.Weight(image, inside) <= strongest) continue;
      strongest = graph.Weight(image, inside);
      best = image;
    }
  }
  return best;
}

}  // namespace

double OverlapOf(const std::vector<std::vector<int>>& clusters, std::size_t cluster) {
  std::size_t shared = 0;
  for (std::size_t other = 0; other < clusters.size(); ++other) {
    if (other == cluster) continue;
    for (const int image : clusters[cluster]) shared += Contains(clusters[other], image) ? 1 : 0;
  }
  return static_cast<double>(shared) / static_cast<double>(clusters[cluster].size());
}

void GrowOverlap(const SimilarityGraph& graph, double min_overlap, int max_size,
                 std::vector<std::vector<int>>& clusters) {
  bool changed = clusters.size() > 1;
  while (changed) {
    changed = false;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      std::vector<int>& cluster = clusters[c];
      if (static_cast<int>(cluster.size()) >= max_size || OverlapOf(clusters, c) >= min_overlap) continue;
      const int image = MostSimilarOutside(graph, cluster);
      if (image < 0) continue;
      cluster.insert(std::lower_bound(cluster.begin(), cluster.end(), image), image);
      changed = true;
    }
  }
}

}  // namespace drupe
