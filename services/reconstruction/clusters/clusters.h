#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "scene/view_graph.h"

namespace drupe {

/// How a set is divided into overlapping groups of similar pictures (paper 3.1.1, eq. 4).
struct ViewClusterOptions {
  int max_cluster_size = 12;  ///< 3..1000; the paper's upper bound
  /// 0..1; clusters grow by shared pictures until the share of their pictures that are also in other clusters reaches
  /// it, as far as max_cluster_size allows (the paper's overlap rate).
  double min_overlap = 0.7;
  /// Sets of up to this many pictures are one cluster in which every pair is matched.
  int exhaustive_max_images = 20;
  /// 1..100; every picture is matched with that many most similar ones, in whatever clusters, so that rings close.
  int links_per_image = 2;
  /// 0..100; every picture is also matched with that many after it in the order of the set, round from the last to the
  /// first: a turntable brings its pictures in order, and a board that looks alike every quarter turn misleads the
  /// Fisher vectors. Where the order means nothing, matching gives such pairs up early.
  int sequence_window = 3;

  /// 400 `invalid_option` naming the field that is out of its range.
  Status Check() const;
};

/// Whether so many pictures are one cluster in which every pair is matched, whatever the graph says.
bool MatchesEveryPair(int image_count, const ViewClusterOptions& options);

/// The size to cut down to before overlap is added. What a cluster takes in from its neighbours and what they take in
/// from it both count as overlap, so half the overlap has to be taken in.
int CoreSizeOf(const ViewClusterOptions& options);

/// Clusters of similar pictures by normalised cut of the similarity graph (Shi & Malik 2000), joined by shared
/// pictures, and the pairs to be matched, whose number grows linearly with that of the pictures. Errors: 400
/// `invalid_option`, 422 `too_few_images` under 2, `cancelled`.
Result<ViewClusters> RunClusters(const SimilarityGraph& graph, const ViewClusterOptions& options,
                                 const RunContext& context);

}  // namespace drupe
