#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/similarity/similarity.h"
#include "scene/features.h"

namespace drupe {

/// Trains the words by which pictures are described, a reduction by principal components and a mixture of Gaussians in
/// the reduced space, on the descriptors of all these pictures (training_images does not count), and gives them as
/// bytes that RunSimilarity takes: "DRPVOCB1", the numbers of reduced dimensions D and Gaussians K (uint32), then
/// float32: mean (128), basis (128 x D, column-major), weights (K), means and variances (D x K each, column-major), and
/// the SHA-256 of all that (64 hexadecimal digits). Little-endian. Errors: 400 `invalid_option`, 422 `no_features`,
/// `cancelled`.
Result<std::string> TrainVocabulary(std::span<const Features> features, const SimilarityOptions& options,
                                    const RunContext& context);

/// The longest vocabulary there is, in bytes; what is longer need not be read.
std::size_t MaxVocabularyBytes();

}  // namespace drupe
