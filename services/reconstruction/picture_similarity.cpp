#include "reconstruction/picture_similarity.h"

#include <algorithm>
#include <utility>

#include "base/digest.h"
#include "base/parallel.h"
#include "reconstruction/derived_cache.h"
#include "reconstruction/picture_features.h"

namespace drupe {
namespace {

Result<SetWords> WordsOf(std::string_view bytes) {
  DRUPE_ASSIGN_OR_RETURN(WordModel model, ReadWords(bytes));
  return SetWords{std::move(model), Sha256Hex(bytes)};
}

bool AnyHasFeatures(std::span<const Features> pictures) {
  return std::any_of(pictures.begin(), pictures.end(), [](const Features& picture) { return picture.size() > 0; });
}

/// The words of the whole set.
Result<SetWords> FrontWords(const PictureSimilarity& similarity, std::span<const SourceImage> pictures,
                            std::span<const Features> features, const SimilarityOptions& options) {
  TrainingFront front(options);
  for (const Features& picture : features) front.Add(picture);
  return similarity.Words(pictures.first(front.size()), features.first(front.size()));
}

Result<SimilarityGraph> LinkAll(const PictureSimilarity& similarity, std::span<const SourceImage> pictures,
                                std::span<const Features> features, const SetWords& words, const RunContext& context) {
  std::vector<Description> descriptions(features.size());
  std::vector<Status> statuses(features.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, features.size(), [&](std::size_t i) {
    Result<Description> description = similarity.Describe(pictures[i], features[i], words);
    statuses[i] = description.status();
    if (description.ok()) descriptions[i] = *std::move(description);
  }));
  for (const Status& status : statuses) DRUPE_RETURN_IF_ERROR(status);
  return LinkDescriptions(descriptions);
}

}  // namespace

PictureSimilarity::PictureSimilarity(const ReconstructionInput& input, const ReconstructionOptions& options,
                                     const RunContext& context)
    : input_(input), options_(options.similarity), context_(context), option_json_(ToJson(options)) {}

Result<SetWords> PictureSimilarity::Words(std::span<const SourceImage> pictures,
                                          std::span<const Features> features) const {
  const auto make = [&]() -> Result<std::string> {
    DRUPE_ASSIGN_OR_RETURN(const WordModel model, TrainWords(features, options_, context_));
    return WriteWords(model);
  };
  const std::optional<std::string> key = WordsKey(pictures);
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, key ? input_.cache->FindOrMake(*key, make, context_) : make());
  return WordsOf(bytes);
}

std::optional<SetWords> PictureSimilarity::KnownWords(std::span<const SourceImage> pictures) const {
  const std::optional<std::string> key = WordsKey(pictures);
  const std::optional<std::string> bytes = key ? input_.cache->Find(*key) : std::nullopt;
  if (!bytes) return std::nullopt;
  Result<SetWords> words = WordsOf(*bytes);
  return words.ok() ? std::optional(*std::move(words)) : std::nullopt;
}

Result<Description> PictureSimilarity::Describe(const SourceImage& picture, const Features& features,
                                                const SetWords& words) const {
  if (!IsCached(picture, input_)) return DescribePicture(features, words.model, options_);
  const auto make = [&]() -> Result<std::string> {
    return WriteDescription(DescribePicture(features, words.model, options_));
  };
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes,
                         input_.cache->FindOrMake(DescriptionKey(picture, words), make, context_));
  return ReadDescription(bytes);
}

std::optional<Description> PictureSimilarity::KnownDescription(const SourceImage& picture,
                                                               const SetWords& words) const {
  if (!IsCached(picture, input_)) return std::nullopt;
  const std::optional<std::string> bytes = input_.cache->Find(DescriptionKey(picture, words));
  if (!bytes) return std::nullopt;
  Result<Description> description = ReadDescription(*bytes);
  return description.ok() ? std::optional(*std::move(description)) : std::nullopt;
}

std::optional<std::string> PictureSimilarity::WordsKey(std::span<const SourceImage> pictures) const {
  Json digests = Json::array();
  for (const SourceImage& picture : pictures) {
    if (!IsCached(picture, input_)) return std::nullopt;
    digests.push_back(picture.sha256);
  }
  if (digests.empty()) return std::nullopt;
  return DerivedKey("words", {{"pictures", digests},
                              {"features", option_json_["features"]},
                              {"similarity", option_json_["similarity"]},
                              {"seed", context_.seed}});
}

std::string PictureSimilarity::DescriptionKey(const SourceImage& picture, const SetWords& words) const {
  return DerivedKey("description", {{"picture", picture.sha256},
                                    {"features", option_json_["features"]},
                                    {"descriptors", options_.descriptors_per_image},
                                    {"words", words.sha256}});
}

Result<std::string> LoadVocabulary(const ReconstructionInput& input, const SimilarityOptions& options) {
  if (options.vocabulary.empty()) return std::string();
  if (!input.read_vocabulary) {
    return InvalidArgument("invalid_option", "no vocabulary can be loaded here", "similarity.vocabulary");
  }
  return input.read_vocabulary(options.vocabulary);
}

Result<SetWords> LoadWords(const std::string& vocabulary) {
  return WordsOf(vocabulary);
}

Result<SimilarityGraph> FindSimilarity(std::span<const SourceImage> pictures, std::span<const Features> features,
                                       const ReconstructionInput& input, const ReconstructionOptions& options,
                                       const std::string& vocabulary, const RunContext& context) {
  const PictureSimilarity similarity(input, options, context);
  SetWords words;
  if (!vocabulary.empty()) {
    DRUPE_ASSIGN_OR_RETURN(words, LoadWords(vocabulary));
  }
  if (MatchesEveryPair(static_cast<int>(features.size()), options.clusters) && AnyHasFeatures(features)) {
    return UndecidedGraph(features.size());
  }
  if (vocabulary.empty()) {
    DRUPE_ASSIGN_OR_RETURN(words, FrontWords(similarity, pictures, features, options.similarity));
  }
  return LinkAll(similarity, pictures, features, words, context);
}

}  // namespace drupe
