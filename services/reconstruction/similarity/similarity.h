#pragma once

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
  int gaussians = 64;                 ///< 1..1024; K of eq. 2
  int pca_dimensions = 32;            ///< 1..128; descriptors are reduced to this many dimensions first
  int training_descriptors = 20'000;  ///< >= 1000; drawn evenly from all pictures
  int em_iterations = 8;              ///< 1..1000
  int descriptors_per_image = 800;    ///< >= 100; the coarsest ones, which are the most repeatable, describe a picture
  /// Where a vocabulary is that was trained before (vocabulary.h): a file for the command line, the digest of an object
  /// for a service. Empty: trained on the set itself. gaussians and pca_dimensions are then the vocabulary's own.
  std::string vocabulary = "";

  /// 400 `invalid_option` naming the field that is out of its range.
  Status Check() const;
};

/// The similarity graph of a set of pictures: the distance of every two Fisher vectors, and the weight of the edge
/// between them (largest distance of all minus theirs). Pictures without features are infinitely unlike: weight 0.
/// `vocabulary`: the bytes that options.vocabulary names; empty: trained on these pictures. Errors: 400
/// `invalid_option`, 422 `no_features` when no picture has any to train on, 422 `bad_vocabulary`, `cancelled`.
Result<SimilarityGraph> RunSimilarity(std::span<const Features> features, const SimilarityOptions& options,
                                      const RunContext& context, std::string_view vocabulary = {});

}  // namespace drupe
