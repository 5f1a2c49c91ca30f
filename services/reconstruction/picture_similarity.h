#pragma once

#include <optional>
#include <span>
#include <string>

#include "base/json.h"
#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/pipeline.h"
#include "reconstruction/similarity/description.h"
#include "reconstruction/similarity/word_model.h"
#include "scene/features.h"
#include "scene/view_graph.h"

namespace drupe {

/// The words of a set, and what names them among all: the SHA-256 of their bytes.
struct SetWords {
  WordModel model;
  std::string sha256;
};

/// The steps of RunSimilarity with a memory: what the cache of the input holds of words and descriptions is taken from
/// there, and what it does not hold is left there. Both follow from the pictures' digests, the options and the seed, so
/// that what was found while pictures arrived is, bit by bit, what the reconstruction would have computed.
class PictureSimilarity {
 public:
  /// All must outlive it. `input.images` is not looked at.
  PictureSimilarity(const ReconstructionInput& input, const ReconstructionOptions& options, const RunContext& context);

  /// The words trained on `pictures`, the TrainingFront of their set, with their `features`. Errors: those of
  /// TrainWords.
  Result<SetWords> Words(std::span<const SourceImage> pictures, std::span<const Features> features) const;
  /// The same where the cache holds them already; nothing where not.
  std::optional<SetWords> KnownWords(std::span<const SourceImage> pictures) const;

  /// How `picture` looks in `words`. Errors: `cancelled`.
  Result<Description> Describe(const SourceImage& picture, const Features& features, const SetWords& words) const;
  /// The same where the cache holds it already; nothing where not.
  std::optional<Description> KnownDescription(const SourceImage& picture, const SetWords& words) const;

 private:
  /// Nothing when what follows from one of the pictures is not kept.
  std::optional<std::string> WordsKey(std::span<const SourceImage> pictures) const;
  std::string DescriptionKey(const SourceImage& picture, const SetWords& words) const;

  const ReconstructionInput& input_;
  const SimilarityOptions& options_;
  const RunContext& context_;
  const Json option_json_;
};

/// The bytes of the vocabulary that the options name; empty when they name none. Errors: 400 `invalid_option` where
/// none can be named, and those of reading.
Result<std::string> LoadVocabulary(const ReconstructionInput& input, const SimilarityOptions& options);

/// The words of a vocabulary that was trained before. Errors: 422 `bad_vocabulary`.
Result<SetWords> LoadWords(const std::string& vocabulary);

/// What RunSimilarity gives of `pictures`, the usable ones of `input` in their order, with their `features`; taken from
/// the cache and left there as far as it can be. Of a set in which every pair is matched anyway, UndecidedGraph.
/// `vocabulary` as in RunSimilarity. Errors: those of RunSimilarity.
Result<SimilarityGraph> FindSimilarity(std::span<const SourceImage> pictures, std::span<const Features> features,
                                       const ReconstructionInput& input, const ReconstructionOptions& options,
                                       const std::string& vocabulary, const RunContext& context);

}  // namespace drupe
