#include "reconstruction/clusters/verified_clusters.h"

#include <algorithm>
#include <string>
#include <utility>

#include "reconstruction/clusters/normalised_cut.h"
#include "reconstruction/clusters/overlap.h"

namespace drupe {
namespace {

/// Weight: verified matches.
Result<SimilarityGraph> WeightsOf(int image_count, const MatchGraph& graph) {
  SimilarityGraph weights;
  weights.image_count = image_count;
  const std::size_t n = image_count < 0 ? 0 : image_count;
  weights.weight.assign(n * n, 0);
  for (const TwoViewMatches& pair : graph.pairs) {
    const auto [first, second] = pair.pair;
    if (first < 0 || first >= second || second >= image_count) {
      return InvalidArgument("invalid_pair", "a verified pair names a picture that does not exist");
    }
    const auto matches = static_cast<float>(pair.matches.size());
    weights.weight[first * n + second] = weights.weight[second * n + first] = matches;
  }
  return weights;
}

/// The images among `images` that chains of edges join to the first of them, ascending.
std::vector<int> Reachable(const SimilarityGraph& graph, const std::vector<int>& images) {
  std::vector<int> found = {images.front()};
  for (std::size_t next = 0; next < found.size(); ++next) {
    for (const int image : images) {
      const bool is_new = std::find(found.begin(), found.end(), image) == found.end();
      if (is_new && graph.Weight(found[next], image) > 0) found.push_back(image);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The connected parts of each cluster, without single images.
std::vector<std::vector<int>> ConnectedParts(const SimilarityGraph& graph,
                                             const std::vector<std::vector<int>>& clusters) {
  std::vector<std::vector<int>> parts;
  for (std::vector<int> rest : clusters) {
    while (!rest.empty()) {
      std::vector<int> part = Reachable(graph, rest), left;
      std::set_difference(rest.begin(), rest.end(), part.begin(), part.end(), std::back_inserter(left));
      if (part.size() > 1) parts.push_back(std::move(part));
      rest = std::move(left);
    }
  }
  return parts;
}

/// Images that have an edge.
std::vector<int> Matched(const SimilarityGraph& graph) {
  std::vector<int> images;
  for (int a = 0; a < graph.image_count; ++a) {
    for (int b = 0; b < graph.image_count; ++b) {
      if (graph.Weight(a, b) <= 0) continue;
      images.push_back(a);
      break;
    }
  }
  return images;
}

}  // namespace

Result<ViewClusters> ClusterVerified(int image_count, const MatchGraph& graph, const ViewClusterOptions& options) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_ASSIGN_OR_RETURN(const SimilarityGraph weights, WeightsOf(image_count, graph));
  ViewClusters result;
  for (const TwoViewMatches& pair : graph.pairs) result.pairs.push_back(pair.pair);
  const std::vector<int> matched = Matched(weights);
  for (const std::vector<int>& part : ConnectedParts(weights, {matched})) {
    const bool is_small = image_count <= std::max(options.exhaustive_max_images, options.max_cluster_size);
    auto cut = DivideByCut(weights, part, is_small ? image_count : CoreSizeOf(options));
    result.clusters.insert(result.clusters.end(), cut.begin(), cut.end());
  }
  result.clusters = ConnectedParts(weights, result.clusters);
  LinkNeighbours(weights, options.max_cluster_size, result.clusters);
  GrowOverlap(weights, options.min_overlap, options.max_cluster_size, result.clusters);
  std::sort(result.clusters.begin(), result.clusters.end());
  return result;
}

}  // namespace drupe
