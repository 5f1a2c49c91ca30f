#include "reconstruction/clusters/clusters.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "base/option_check.h"
#include "reconstruction/clusters/normalised_cut.h"
#include "reconstruction/clusters/overlap.h"

namespace drupe {
namespace {

using PairSet = std::set<std::pair<int, int>>;

Status CheckGraph(const SimilarityGraph& graph) {
  const std::size_t n = graph.image_count < 0 ? 0 : graph.image_count;
  if (n < 2) return Unprocessable("too_few_images", "pairs need at least 2 pictures");
  if (graph.weight.size() != n * n) return InvalidArgument("invalid_graph", "the graph needs a weight for every pair");
  return Status::Ok();
}

void AddPairsInside(const std::vector<int>& cluster, PairSet& pairs) {
  for (std::size_t i = 0; i < cluster.size(); ++i) {
    for (std::size_t j = i + 1; j < cluster.size(); ++j) pairs.emplace(cluster[i], cluster[j]);
  }
}

/// Links every image with its most similar ones, whatever clusters they are in: where they are in the same, the pair is
/// there already.
void AddLinks(const SimilarityGraph& graph, int links_per_image, PairSet& pairs) {
  for (int image = 0; image < graph.image_count; ++image) {
    std::vector<int> others;
    for (int other = 0; other < graph.image_count; ++other) {
      if (other != image) others.push_back(other);
    }
    std::stable_sort(others.begin(), others.end(),
                     [&](int a, int b) { return graph.Weight(image, a) > graph.Weight(image, b); });
    if (static_cast<int>(others.size()) > links_per_image) others.resize(links_per_image);
    for (const int other : others) pairs.emplace(std::min(image, other), std::max(image, other));
  }
}

/// Links every image with the `window` that follow it, the last ones with the first.
void AddSequence(int image_count, int window, PairSet& pairs) {
  for (int image = 0; image < image_count; ++image) {
    for (int step = 1; step <= std::min(window, image_count - 1); ++step) {
      const int other = (image + step) % image_count;
      pairs.emplace(std::min(image, other), std::max(image, other));
    }
  }
}

}  // namespace

bool MatchesEveryPair(int image_count, const ViewClusterOptions& options) {
  return image_count <= std::max(options.exhaustive_max_images, options.max_cluster_size);
}

int CoreSizeOf(const ViewClusterOptions& options) {
  const double core = options.max_cluster_size * (1 - 0.5 * options.min_overlap);
  return std::max(2, static_cast<int>(core));
}

Status ViewClusterOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(
      CheckOption(max_cluster_size >= 3 && max_cluster_size <= 1000, "max_cluster_size", "3 to 1000"));
  DRUPE_RETURN_IF_ERROR(CheckOption(min_overlap >= 0 && min_overlap <= 1, "min_overlap", "0 to 1"));
  DRUPE_RETURN_IF_ERROR(CheckOption(exhaustive_max_images >= 0, "exhaustive_max_images", "0 or more"));
  DRUPE_RETURN_IF_ERROR(CheckOption(sequence_window >= 0 && sequence_window <= 100, "sequence_window", "0 to 100"));
  return CheckOption(links_per_image >= 1 && links_per_image <= 100, "links_per_image", "1 to 100");
}

Result<ViewClusters> RunClusters(const SimilarityGraph& graph, const ViewClusterOptions& options,
                                 const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_RETURN_IF_ERROR(CheckGraph(graph));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  ViewClusters result;
  std::vector<int> all(graph.image_count);
  std::iota(all.begin(), all.end(), 0);
  const bool is_small = MatchesEveryPair(graph.image_count, options);
  result.clusters = DivideByCut(graph, all, is_small ? graph.image_count : CoreSizeOf(options));
  GrowOverlap(graph, options.min_overlap, options.max_cluster_size, result.clusters);
  PairSet pairs;
  for (const std::vector<int>& cluster : result.clusters) AddPairsInside(cluster, pairs);
  AddLinks(graph, options.links_per_image, pairs);
  AddSequence(graph.image_count, options.sequence_window, pairs);
  for (const auto& [first, second] : pairs) result.pairs.push_back({first, second});
  return result;
}

}  // namespace drupe
