#include "reconstruction/similarity/similarity.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "reconstruction/similarity/fisher_vector.h"
#include "reconstruction/similarity/gaussian_mixture.h"
#include "reconstruction/similarity/pca.h"

namespace drupe {
namespace {

Status CheckRange(bool ok, const char* field, const char* range) {
  if (ok) return Status::Ok();
  return InvalidArgument("invalid_option", std::string(field) + " must be " + range, field);
}

/// Every `stride`-th of the picture's first `limit` descriptors, one a column.
SampleMatrix DescriptorsOf(const Features& picture, std::size_t limit, std::size_t stride) {
  const std::size_t available = std::min(picture.size(), limit);
  const auto count = static_cast<Eigen::Index>((available + stride - 1) / stride);
  SampleMatrix samples(Features::kDimension, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::uint8_t* descriptor = picture.Descriptor(static_cast<std::size_t>(i) * stride);
    for (int k = 0; k < Features::kDimension; ++k) samples(k, i) = static_cast<float>(descriptor[k]) / 512;
  }
  return samples;
}

/// Descriptors drawn evenly from all pictures, about `wanted` in all.
SampleMatrix TrainingSet(std::span<const Features> features, const SimilarityOptions& options) {
  std::size_t total = 0;
  for (const Features& picture : features)
    total += std::min<std::size_t>(picture.size(), options.descriptors_per_image);
  const std::size_t stride = std::max<std::size_t>(1, total / options.training_descriptors);
  std::vector<SampleMatrix> parts;
  Eigen::Index columns = 0;
  for (const Features& picture : features) {
    parts.push_back(DescriptorsOf(picture, options.descriptors_per_image, stride));
    columns += parts.back().cols();
  }
  SampleMatrix all(Features::kDimension, columns);
  Eigen::Index at = 0;
  for (const SampleMatrix& part : parts) {
    all.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  return all;
}

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
  DRUPE_RETURN_IF_ERROR(CheckRange(gaussians >= 1 && gaussians <= 1024, "gaussians", "1 to 1024"));
  DRUPE_RETURN_IF_ERROR(
      CheckRange(pca_dimensions >= 1 && pca_dimensions <= Features::kDimension, "pca_dimensions", "1 to 128"));
  DRUPE_RETURN_IF_ERROR(CheckRange(training_descriptors >= 1000, "training_descriptors", "1000 or more"));
  DRUPE_RETURN_IF_ERROR(CheckRange(em_iterations >= 1 && em_iterations <= 1000, "em_iterations", "1 to 1000"));
  return CheckRange(descriptors_per_image >= 100, "descriptors_per_image", "100 or more");
}

Result<SimilarityGraph> RunSimilarity(std::span<const Features> features, const SimilarityOptions& options,
                                      const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  const SampleMatrix training = TrainingSet(features, options);
  if (training.cols() == 0) {
    return Unprocessable("no_features", "none of the pictures has a feature; are they sharp and lit?");
  }
  const Pca pca = FitPca(training, options.pca_dimensions);
  const int components = static_cast<int>(std::min<Eigen::Index>(options.gaussians, training.cols()));
  DRUPE_ASSIGN_OR_RETURN(const GaussianMixture mixture,
                         FitGaussianMixture(pca.Reduce(training), components, options.em_iterations, context));
  std::vector<Eigen::VectorXf> fisher(features.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, features.size(), [&](std::size_t i) {
    fisher[i] = FisherVector(pca.Reduce(DescriptorsOf(features[i], options.descriptors_per_image, 1)), mixture);
  }));
  return GraphOf(fisher);
}

}  // namespace drupe
