#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/similarity/gaussian_mixture.h"
#include "reconstruction/similarity/pca.h"
#include "reconstruction/similarity/similarity.h"
#include "scene/features.h"

namespace drupe {

/// A vocabulary ready for use: TrainVocabulary's reduction and mixture.
struct WordModel {
  Pca pca;
  GaussianMixture mixture;
};

/// Every `stride`-th of the picture's first `limit` descriptors, one a column, L2 norm about 1.
SampleMatrix DescriptorSamples(const Features& picture, std::size_t limit, std::size_t stride);

/// Trains on all of `features`. Errors: 422 `no_features`, `cancelled`.
Result<WordModel> TrainWords(std::span<const Features> features, const SimilarityOptions& options,
                             const RunContext& context);

/// The bytes that vocabulary.h describes, and back: the same numbers, bit by bit. Nothing is believed before length and
/// digest agree. Errors: 422 `bad_vocabulary` (another format or version, cut off, damaged, sizes or numbers out of
/// range).
std::string WriteWords(const WordModel& model);
Result<WordModel> ReadWords(std::string_view bytes);

/// The most numbers that describe a picture in words of any size.
std::size_t MaxDescriptionLength();

}  // namespace drupe
