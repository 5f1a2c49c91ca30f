#include "reconstruction/arrived_picture.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "reconstruction/picture_features.h"
#include "reconstruction/picture_similarity.h"

namespace drupe {
namespace {

constexpr std::size_t kCandidates = 5;

class ArrivedPicture {
 public:
  ArrivedPicture(const SourceImage& arrived, const Features& features, const ReconstructionInput& set,
                 const ReconstructionOptions& options, const RunContext& context)
      : arrived_(arrived),
        features_(features),
        set_(set),
        options_(options),
        context_(context),
        place_(PlaceOf(arrived, set.images)),
        similarity_(set, options, context) {}

  Result<std::vector<std::string>> Run() {
    if (place_ == set_.images.size()) return std::vector<std::string>();
    DRUPE_ASSIGN_OR_RETURN(const std::optional<SetWords> words, FindWords());
    if (!words) return std::vector<std::string>();
    DRUPE_ASSIGN_OR_RETURN(const Description description, similarity_.Describe(arrived_, features_, *words));
    return Candidates(description, *words);
  }

 private:
  Result<std::optional<SetWords>> FindWords() {
    DRUPE_ASSIGN_OR_RETURN(const std::string vocabulary, LoadVocabulary(set_, options_.similarity));
    if (!vocabulary.empty()) {
      DRUPE_ASSIGN_OR_RETURN(SetWords words, LoadWords(vocabulary));
      return std::optional(std::move(words));
    }
    const auto wanted = static_cast<std::size_t>(options_.similarity.training_images);
    if (wanted == 0 || set_.images.size() < wanted) return std::optional<SetWords>();
    std::optional<SetWords> known = similarity_.KnownWords(std::span(set_.images).first(wanted));
    if (known) return known;
    return TrainOnFront();
  }

  /// Nothing when the front is not complete with the picture that arrived.
  Result<std::optional<SetWords>> TrainOnFront() {
    const std::size_t limit = place_ + 1;
    if (limit < static_cast<std::size_t>(options_.similarity.training_images)) return std::optional<SetWords>();
    TrainingFront front(options_.similarity);
    std::vector<Features> features;
    while (!front.IsComplete() && front.size() < limit) {
      DRUPE_ASSIGN_OR_RETURN(Features next, FindFeatures(set_.images[front.size()], set_, options_, context_));
      front.Add(next);
      features.push_back(std::move(next));
    }
    if (!front.IsComplete()) return std::optional<SetWords>();
    return DescribeFront(std::span(set_.images).first(front.size()), features);
  }

  Result<std::optional<SetWords>> DescribeFront(std::span<const SourceImage> pictures,
                                                std::span<const Features> features) {
    DRUPE_ASSIGN_OR_RETURN(SetWords words, similarity_.Words(pictures, features));
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      DRUPE_RETURN_IF_ERROR(context_.CheckCancelled());
      DRUPE_RETURN_IF_ERROR(similarity_.Describe(pictures[i], features[i], words).status());
    }
    return std::optional(std::move(words));
  }

  /// Among the pictures that have been described.
  std::vector<std::string> Candidates(const Description& description, const SetWords& words) const {
    std::vector<std::string> names;
    std::vector<Description> descriptions;
    for (const SourceImage& other : set_.images) {
      if (other.name == arrived_.name) continue;
      std::optional<Description> known = similarity_.KnownDescription(other, words);
      if (!known) continue;
      names.push_back(other.name);
      descriptions.push_back(*std::move(known));
    }
    std::vector<std::string> candidates;
    for (const std::size_t i : MostAlike(description, descriptions, kCandidates)) candidates.push_back(names[i]);
    return candidates;
  }

  const SourceImage& arrived_;
  const Features& features_;
  const ReconstructionInput& set_;
  const ReconstructionOptions& options_;
  const RunContext& context_;
  const std::size_t place_;
  const PictureSimilarity similarity_;
};

}  // namespace

std::size_t PlaceOf(const SourceImage& arrived, std::span<const SourceImage> images) {
  const auto found = std::find_if(images.begin(), images.end(), [&](const SourceImage& image) {
    return image.name == arrived.name && image.sha256 == arrived.sha256;
  });
  return static_cast<std::size_t>(found - images.begin());
}

Result<std::vector<std::string>> DescribeArrived(const SourceImage& arrived, const Features& features,
                                                 const ReconstructionInput& set, const ReconstructionOptions& options,
                                                 const RunContext& context) {
  return ArrivedPicture(arrived, features, set, options, context).Run();
}

}  // namespace drupe
