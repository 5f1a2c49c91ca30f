#include "reconstruction/similarity/similarity.h"

#include <algorithm>
#include <vector>

#include "base/option_check.h"
#include "base/parallel.h"
#include "reconstruction/similarity/description.h"
#include "reconstruction/similarity/word_model.h"

namespace drupe {
namespace {

/// A picture that has fewer than one in so many of descriptors_per_image is nearly blank.
constexpr int kCountingDivisor = 8;

}  // namespace

Status SimilarityOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(CheckOption(gaussians >= 1 && gaussians <= 1024, "gaussians", "1 to 1024"));
  DRUPE_RETURN_IF_ERROR(
      CheckOption(pca_dimensions >= 1 && pca_dimensions <= Features::kDimension, "pca_dimensions", "1 to 128"));
  DRUPE_RETURN_IF_ERROR(CheckOption(training_images >= 0, "training_images", "0 or more"));
  DRUPE_RETURN_IF_ERROR(CheckOption(training_descriptors >= 1000, "training_descriptors", "1000 or more"));
  DRUPE_RETURN_IF_ERROR(CheckOption(em_iterations >= 1 && em_iterations <= 1000, "em_iterations", "1 to 1000"));
  return CheckOption(descriptors_per_image >= 100, "descriptors_per_image", "100 or more");
}

TrainingFront::TrainingFront(const SimilarityOptions& options)
    : enough_(static_cast<std::size_t>(std::max(1, options.descriptors_per_image / kCountingDivisor))),
      wanted_(options.training_images > 0 ? options.training_images : -1) {}

void TrainingFront::Add(const Features& picture) {
  if (IsComplete()) return;
  ++size_;
  if (wanted_ > 0 && picture.size() >= enough_) --wanted_;
}

Result<SimilarityGraph> RunSimilarity(std::span<const Features> features, const SimilarityOptions& options,
                                      const RunContext& context, std::string_view vocabulary) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  TrainingFront front(options);
  for (const Features& picture : features) front.Add(picture);
  DRUPE_ASSIGN_OR_RETURN(const WordModel words, vocabulary.empty()
                                                    ? TrainWords(features.first(front.size()), options, context)
                                                    : ReadWords(vocabulary));
  std::vector<Description> descriptions(features.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, features.size(), [&](std::size_t i) {
    descriptions[i] = DescribePicture(features[i], words, options);
  }));
  return LinkDescriptions(descriptions);
}

SimilarityGraph UndecidedGraph(std::size_t pictures) {
  SimilarityGraph graph;
  graph.image_count = static_cast<int>(pictures);
  graph.fisher_distance.assign(pictures * pictures, 0);
  graph.weight.assign(pictures * pictures, 0);
  return graph;
}

}  // namespace drupe
