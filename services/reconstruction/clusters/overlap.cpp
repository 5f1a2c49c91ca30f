#include "reconstruction/clusters/overlap.h"

#include <algorithm>
#include <utility>

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

void Insert(std::vector<int>& cluster, int image) {
  cluster.insert(std::lower_bound(cluster.begin(), cluster.end(), image), image);
}

/// Takes in the most similar image from outside. False when there is none.
bool TakeIn(const SimilarityGraph& graph, std::vector<int>& cluster) {
  const int image = MostSimilarOutside(graph, cluster);
  if (image >= 0) Insert(cluster, image);
  return image >= 0;
}

/// Lends one image of a full cluster to the cluster with room that it is most similar to. False when there is none.
bool Lend(const SimilarityGraph& graph, std::size_t from, std::size_t max_size,
          std::vector<std::vector<int>>& clusters) {
  int lent = -1;
  std::size_t to = 0;
  float strongest = -1;
  for (std::size_t other = 0; other < clusters.size(); ++other) {
    if (other == from || clusters[other].size() >= max_size) continue;
    for (const int image : clusters[from]) {
      if (Contains(clusters[other], image)) continue;
      for (const int inside : clusters[other]) {
        if (graph.Weight(image, inside) <= strongest) continue;
        strongest = graph.Weight(image, inside);
        lent = image;
        to = other;
      }
    }
  }
  if (lent >= 0) Insert(clusters[to], lent);
  return lent >= 0;
}

/// The edges between two clusters.
struct Border {
  float strongest = 0;
  int first = -1, second = -1;  ///< ends of the strongest
};

Border BorderOf(const SimilarityGraph& graph, const std::vector<int>& a, const std::vector<int>& b) {
  Border border;
  for (const int first : a) {
    for (const int second : b) {
      const float weight = graph.Weight(first, second);
      if (weight <= border.strongest) continue;
      border.strongest = weight;
      border.first = first;
      border.second = second;
    }
  }
  return border;
}

void InsertIfRoom(std::vector<int>& cluster, int image, std::size_t max_size) {
  if (cluster.size() < max_size && !Contains(cluster, image)) Insert(cluster, image);
}

}  // namespace

void LinkNeighbours(const SimilarityGraph& graph, int max_size, std::vector<std::vector<int>>& clusters) {
  constexpr std::size_t kNeighbours = 2;
  const std::vector<std::vector<int>> cores = clusters;
  for (std::size_t a = 0; a < cores.size(); ++a) {
    std::vector<std::pair<float, std::size_t>> neighbours;  // strongest first
    for (std::size_t b = 0; b < cores.size(); ++b) {
      const float strongest = a == b ? 0 : BorderOf(graph, cores[a], cores[b]).strongest;
      if (strongest > 0) neighbours.emplace_back(-strongest, b);
    }
    std::sort(neighbours.begin(), neighbours.end());
    if (neighbours.size() > kNeighbours) neighbours.resize(kNeighbours);
    for (const auto& [strength, b] : neighbours) {
      const Border border = BorderOf(graph, cores[a], cores[b]);
      InsertIfRoom(clusters[a], border.second, max_size);
      InsertIfRoom(clusters[b], border.first, max_size);
    }
  }
}

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
  const auto limit = static_cast<std::size_t>(max_size);
  bool changed = clusters.size() > 1;
  while (changed) {
    changed = false;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      if (OverlapOf(clusters, c) >= min_overlap) continue;
      changed |= clusters[c].size() < limit ? TakeIn(graph, clusters[c]) : Lend(graph, c, limit, clusters);
    }
  }
}

}  // namespace drupe
