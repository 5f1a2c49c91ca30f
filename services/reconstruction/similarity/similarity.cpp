#include "reconstruction/similarity/similarity.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/option_check.h"
#include "base/parallel.h"
#include "reconstruction/similarity/fisher_vector.h"
#include "reconstruction/similarity/word_model.h"

namespace drupe {
namespace {

/// Distances of all pairs; pictures without features are 2, the largest distance unit vectors can have, from all
/// others.
SimilarityGraph GraphOf(const std::vector<Eigen::VectorXf>& fisher) {
  SimilarityGraph graph;
  graph.image_count = static_cast<int>(fisher.size());
  const std::size_t n = fisher.size();
  graph.fisher_distance.assign(n * n, 0);
  graph.weight.assign(n * n, 0);
  float extreme = 0;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < n; ++b) {
      if (a == b) continue;
      const bool has_both = fisher[a].squaredNorm() > 0 && fisher[b].squaredNorm() > 0;
      graph.fisher_distance[a * n + b] = has_both ? (fisher[a] - fisher[b]).norm() : 2;
      extreme = std::max(extreme, graph.fisher_distance[a * n + b]);
    }
  }
  for (std::size_t i = 0; i < n * n; ++i) graph.weight[i] = extreme - graph.fisher_distance[i];
  return graph;
}

}  // namespace

Status SimilarityOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(CheckOption(gaussians >= 1 && gaussians <= 1024, "gaussians", "1 to 1024"));
  DRUPE_RETURN_IF_ERROR(
      CheckOption(pca_dimensions >= 1 && pca_dimensions <= Features::kDimension, "pca_dimensions", "1 to 128"));
  DRUPE_RETURN_IF_ERROR(CheckOption(training_descriptors >= 1000, "training_descriptors", "1000 or more"));
  DRUPE_RETURN_IF_ERROR(CheckOption(em_iterations >= 1 && em_iterations <= 1000, "em_iterations", "1 to 1000"));
  return CheckOption(descriptors_per_image >= 100, "descriptors_per_image", "100 or more");
}

Result<SimilarityGraph> RunSimilarity(std::span<const Features> features, const SimilarityOptions& options,
                                      const RunContext& context, std::string_view vocabulary) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_ASSIGN_OR_RETURN(const WordModel words,
                         vocabulary.empty() ? TrainWords(features, options, context) : ReadWords(vocabulary));
  std::vector<Eigen::VectorXf> fisher(features.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, features.size(), [&](std::size_t i) {
    const SampleMatrix samples = DescriptorSamples(features[i], options.descriptors_per_image, 1);
    fisher[i] = FisherVector(words.pca.Reduce(samples), words.mixture);
  }));
  return GraphOf(fisher);
}

}  // namespace drupe
