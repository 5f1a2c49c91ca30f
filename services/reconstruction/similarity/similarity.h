#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "base/run_context.h"
#include "base/status.h"
#include "scene/features.h"
#include "scene/view_graph.h"

namespace drupe {

/// How the likeness of pictures is measured by Fisher vectors (paper eqs 1-3; Perronnin, Sanchez & Mensink 2010).
struct SimilarityOptions {
  int gaussians = 64;       ///< 1..1024; K of eq. 2
  int pca_dimensions = 32;  ///< 1..128; descriptors are reduced to this many dimensions first
  /// >= 0; the words are trained on so many pictures at the front of the set (TrainingFront), so that every later one
  /// can be described as it comes; 0: on all.
  int training_images = 12;
  int training_descriptors = 20'000;  ///< >= 1000; drawn evenly from the pictures that the words are trained on
  int em_iterations = 8;              ///< 1..1000
  int descriptors_per_image = 800;    ///< >= 100; the coarsest ones, which are the most repeatable, describe a picture
  /// Where a vocabulary is that was trained before (vocabulary.h): a file for the command line, the digest of an object
  /// for a service; gaussians and pca_dimensions are then the vocabulary's own. Empty: trained on the set itself.
  std::string vocabulary = "";

  /// 400 `invalid_option` naming the field that is out of its range.
  Status Check() const;
};

/// Says which pictures at the front of a set its words are trained on, told one picture after the other in the order of
/// the set: those up to the one with which training_images have features enough to count (an eighth of
/// descriptors_per_image). What comes after that front never changes it.
class TrainingFront {
 public:
  explicit TrainingFront(const SimilarityOptions& options);

  /// Takes the next picture into the front, unless it IsComplete().
  void Add(const Features& picture);
  /// Never when training_images is 0: then, and where a set has too few that count, it is trained on all.
  bool IsComplete() const { return wanted_ == 0; }
  /// The number of pictures in the front.
  std::size_t size() const { return size_; }

 private:
  const std::size_t enough_;
  int wanted_;
  std::size_t size_ = 0;
};

/// The similarity graph of a set of pictures: the distance of every two Fisher vectors, and the weight of the edge
/// between them (largest distance of all minus theirs). Pictures without features are infinitely unlike: weight 0.
/// `vocabulary`: the bytes that options.vocabulary names; empty: trained on the TrainingFront. It is made of the steps
/// TrainWords (word_model.h), DescribePicture and LinkDescriptions (description.h), which can also be taken one by one
/// while pictures arrive. Errors: 400 `invalid_option`, 422 `no_features` when no picture has any to train on, 422
/// `bad_vocabulary`, `cancelled`.
Result<SimilarityGraph> RunSimilarity(std::span<const Features> features, const SimilarityOptions& options,
                                      const RunContext& context, std::string_view vocabulary = {});

/// The graph of so many pictures among which nothing tells which are alike: all distances and weights 0. Enough where
/// every pair is matched anyway.
SimilarityGraph UndecidedGraph(std::size_t pictures);

}  // namespace drupe
